/* A unit by FMI 3.0 for co-simulation; the rest of its functions are in fmi3_absent.c. */
#include "fmi3.h"
#include "unit.h"

#include <stdlib.h>

static void report(const struct importer *to, enum status status, const char *category,
                   const char *message)
{
  if (to->logger)
    ((fmi3LogMessageCallback)to->logger)(to->environment, (fmi3Status)status, category, message);
}

EXPORT const char *fmi3GetVersion(void)
{
  return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n,
                                      const fmi3String categories[])
{
  (void)c, (void)on, (void)n, (void)categories;
  return fmi3OK;    /* warnings and errors are always reported, and there is nothing else */
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
  fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
  fmi3Boolean logging, fmi3Boolean has_events, fmi3Boolean may_return_early,
  const fmi3ValueReference intermediate[], size_t n_intermediate,
  fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
  fmi3IntermediateUpdateCallback update)
{
  (void)resources, (void)visible, (void)logging, (void)may_return_early, (void)intermediate;
  (void)update;
  if (!name || !token) return NULL;
  const struct importer importer = {name, environment, (void (*)(void))logger, report};
  if (has_events) return unit_refuse_creation(&importer, "event mode");
  if (n_intermediate) return unit_refuse_creation(&importer, "an intermediate update");
  return unit_create(&importer, token);
}

static fmi3Instance refuse(fmi3String name, fmi3InstanceEnvironment environment,
                           fmi3LogMessageCallback logger, const char *what)
{
  const struct importer importer = {name, environment, (void (*)(void))logger, report};
  return unit_refuse_creation(&importer, what);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(
  fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
  fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
  (void)token, (void)resources, (void)visible, (void)logging;
  return refuse(name, environment, logger, "model exchange");
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
  fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
  fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
  fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
  fmi3UnlockPreemptionCallback unlock)
{
  (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock;
  (void)unlock;
  return refuse(name, environment, logger, "scheduled execution");
}

EXPORT void fmi3FreeInstance(fmi3Instance c)
{
  unit_free(c);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance,
                                              fmi3Float64 tolerance, fmi3Float64 begin,
                                              fmi3Boolean has_end, fmi3Float64 end)
{
  enum status status;
  (void)has_tolerance, (void)tolerance, (void)has_end, (void)end;
  status = unit_set_begin(c, begin);
  return (fmi3Status)(status == STATUS_OK ? unit_begin(c) : status);
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
  return (fmi3Status)unit_end_begin(c);
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c)
{
  return (fmi3Status)unit_terminate(c);
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c)
{
  return (fmi3Status)unit_reset(c);
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                 fmi3Float64 value[], size_t n_values)
{
  if (n != n_values) return (fmi3Status)unit_refuse(c, "another number of values");
  return (fmi3Status)unit_read(c, TYPE_REAL, vr, n, value);
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                 const fmi3Float64 value[], size_t n_values)
{
  if (n != n_values) return (fmi3Status)unit_refuse(c, "another number of values");
  return (fmi3Status)unit_write(c, TYPE_REAL, vr, n, value);
}

/* Getter and setter of a type whose values are whole numbers here. */
#define WHOLE(NAME, TYPE)                                                                      \
  EXPORT fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,     \
                                  fmi3##NAME value[], size_t n_values)                         \
  {                                                                                            \
    if (n != n_values) return (fmi3Status)unit_refuse(c, "another number of values");          \
    for (size_t k = 0; k < n; k++) {                                                           \
      int64_t found;                                                                           \
      if (unit_read_whole(c, TYPE, vr[k], &found) != STATUS_OK) return fmi3Error;              \
      value[k] = (fmi3##NAME)found;                                                            \
    }                                                                                          \
    return fmi3OK;                                                                             \
  }                                                                                            \
  EXPORT fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,     \
                                  const fmi3##NAME value[], size_t n_values)                   \
  {                                                                                            \
    enum status status = STATUS_OK;                                                            \
    if (n != n_values) return (fmi3Status)unit_refuse(c, "another number of values");          \
    for (size_t k = 0; k < n; k++) {                                                           \
      const double given = (double)value[k];                                                   \
      const enum status own = unit_write(c, TYPE, vr + k, 1, &given);                          \
      if (own > status) status = own;                                                          \
    }                                                                                          \
    return (fmi3Status)status;                                                                 \
  }

WHOLE(Int32, TYPE_INTEGER)
WHOLE(Int64, TYPE_ENUMERATION)
WHOLE(Boolean, TYPE_BOOLEAN)

/* Getter and setter of a type that no variable of a unit has. */
#define NO_VARIABLE(NAME)                                                                      \
  EXPORT fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,     \
                                  fmi3##NAME value[], size_t n_values)                         \
  {                                                                                            \
    (void)vr, (void)value, (void)n_values;                                                     \
    return n ? (fmi3Status)unit_refuse(c, "a variable of type " #NAME) : fmi3OK;               \
  }                                                                                            \
  EXPORT fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,     \
                                  const fmi3##NAME value[], size_t n_values)                   \
  {                                                                                            \
    (void)vr, (void)value, (void)n_values;                                                     \
    return n ? (fmi3Status)unit_refuse(c, "a variable of type " #NAME) : fmi3OK;               \
  }

NO_VARIABLE(Float32)
NO_VARIABLE(Int8)
NO_VARIABLE(UInt8)
NO_VARIABLE(Int16)
NO_VARIABLE(UInt16)
NO_VARIABLE(UInt32)
NO_VARIABLE(UInt64)

EXPORT fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                fmi3String value[], size_t n_values)
{
  if (n != n_values) return (fmi3Status)unit_refuse(c, "another number of values");
  for (size_t k = 0; k < n; k++)
    if (unit_read_text(c, vr[k], value + k) != STATUS_OK) return fmi3Error;
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                const fmi3String value[], size_t n_values)
{
  (void)vr, (void)value, (void)n_values;
  return n ? (fmi3Status)unit_refuse(c, "to set a text") : fmi3OK;
}

EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                size_t sizes[], fmi3Binary value[], size_t n_values)
{
  (void)vr, (void)sizes, (void)value, (void)n_values;
  return n ? (fmi3Status)unit_refuse(c, "a variable of type Binary") : fmi3OK;
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                const size_t sizes[], const fmi3Binary value[], size_t n_values)
{
  (void)vr, (void)sizes, (void)value, (void)n_values;
  return n ? (fmi3Status)unit_refuse(c, "a variable of type Binary") : fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
  return (fmi3Status)unit_get_state(c, state);
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
  return (fmi3Status)unit_set_state(c, state);
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
  (void)c;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
  (void)c, (void)state;
  *size = unit_state_size();
  return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[],
                                        size_t size)
{
  return (fmi3Status)unit_serialize(c, state, bytes, size);
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                          fmi3FMUState *state)
{
  return (fmi3Status)unit_deserialize(c, bytes, size, state);
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 size,
                             fmi3Boolean is_final, fmi3Boolean *needs_events,
                             fmi3Boolean *terminates, fmi3Boolean *is_early, fmi3Float64 *reached)
{
  enum status status;
  (void)is_final;
  status = unit_step(c, from, size);
  *needs_events = *terminates = *is_early = false;
  *reached = unit_time(c);
  return (fmi3Status)status;
}
