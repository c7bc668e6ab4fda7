/*
 * A unit by FMI 3.0 for co-simulation.
 *
 * The types are those of the standard's headers, by its text (version 3.0.2). Types of values that
 * no variable of a unit has, and what co-simulation with a fixed tick does not have, is refused
 * with a message.
 */
#include "unit.h"

#include <stdbool.h>
#include <stdlib.h>

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3IntervalNotYetKnown } fmi3IntervalQualifier;
typedef enum { fmi3Independent } fmi3DependencyKind;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                       fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(
  fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean, fmi3Boolean, fmi3Boolean,
  fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

static void report(const unit_t *unit, enum status status, const char *category,
                   const char *message)
{
  const struct importer *own = unit_importer(unit);
  if (own->logger)
    ((fmi3LogMessageCallback)own->logger)(own->environment, (fmi3Status)status, category, message);
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
  if (!name || !token || has_events || n_intermediate) return NULL;
  const struct importer importer = {name, environment, (void (*)(void))logger, report};
  return unit_create(&importer, token);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(
  fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
  fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment;
  (void)logger;
  return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
  fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
  fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
  fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
  fmi3UnlockPreemptionCallback unlock)
{
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment;
  (void)logger, (void)update, (void)lock, (void)unlock;
  return NULL;
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

/* A function that a unit of this kind does not have; ARGUMENTS stands in parentheses. */
#define NO_FUNCTION(NAME, ARGUMENTS)         \
  EXPORT fmi3Status fmi3##NAME ARGUMENTS     \
  {                                          \
    return (fmi3Status)unit_refuse(c, #NAME); \
  }

#define REFERENCES const fmi3ValueReference vr[], size_t n
#define FLOATS fmi3Float64 values[], size_t n_values

#pragma GCC diagnostic ignored "-Wunused-parameter"

NO_FUNCTION(EnterEventMode, (fmi3Instance c))
NO_FUNCTION(EnterConfigurationMode, (fmi3Instance c))
NO_FUNCTION(ExitConfigurationMode, (fmi3Instance c))
NO_FUNCTION(EnterContinuousTimeMode, (fmi3Instance c))
NO_FUNCTION(EnterStepMode, (fmi3Instance c))
NO_FUNCTION(EvaluateDiscreteStates, (fmi3Instance c))
NO_FUNCTION(UpdateDiscreteStates,
            (fmi3Instance c, fmi3Boolean *needed, fmi3Boolean *terminates, fmi3Boolean *nominals,
             fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next))
NO_FUNCTION(GetClock, (fmi3Instance c, REFERENCES, fmi3Clock values[]))
NO_FUNCTION(SetClock, (fmi3Instance c, REFERENCES, const fmi3Clock values[]))
NO_FUNCTION(GetIntervalDecimal,
            (fmi3Instance c, REFERENCES, fmi3Float64 intervals[],
             fmi3IntervalQualifier qualifiers[]))
NO_FUNCTION(GetIntervalFraction,
            (fmi3Instance c, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
             fmi3IntervalQualifier qualifiers[]))
NO_FUNCTION(GetShiftDecimal, (fmi3Instance c, REFERENCES, fmi3Float64 shifts[]))
NO_FUNCTION(GetShiftFraction,
            (fmi3Instance c, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
NO_FUNCTION(SetIntervalDecimal, (fmi3Instance c, REFERENCES, const fmi3Float64 intervals[]))
NO_FUNCTION(SetIntervalFraction,
            (fmi3Instance c, REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[]))
NO_FUNCTION(SetShiftDecimal, (fmi3Instance c, REFERENCES, const fmi3Float64 shifts[]))
NO_FUNCTION(SetShiftFraction,
            (fmi3Instance c, REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[]))
NO_FUNCTION(GetNumberOfVariableDependencies,
            (fmi3Instance c, fmi3ValueReference vr, size_t *n))
NO_FUNCTION(GetVariableDependencies,
            (fmi3Instance c, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[],
             size_t elements[], fmi3DependencyKind kinds[], size_t n))
NO_FUNCTION(GetDirectionalDerivative,
            (fmi3Instance c, REFERENCES, const fmi3ValueReference known[], size_t n_known,
             const fmi3Float64 seed[], size_t n_seed, FLOATS))
NO_FUNCTION(GetAdjointDerivative,
            (fmi3Instance c, REFERENCES, const fmi3ValueReference known[], size_t n_known,
             const fmi3Float64 seed[], size_t n_seed, FLOATS))
NO_FUNCTION(GetOutputDerivatives,
            (fmi3Instance c, REFERENCES, const fmi3Int32 orders[], FLOATS))
NO_FUNCTION(CompletedIntegratorStep,
            (fmi3Instance c, fmi3Boolean is_final, fmi3Boolean *event, fmi3Boolean *terminates))
NO_FUNCTION(SetTime, (fmi3Instance c, fmi3Float64 time))
NO_FUNCTION(SetContinuousStates, (fmi3Instance c, const fmi3Float64 values[], size_t n_values))
NO_FUNCTION(GetContinuousStates, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetContinuousStateDerivatives, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetNominalsOfContinuousStates, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetEventIndicators, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetNumberOfEventIndicators, (fmi3Instance c, size_t *n))
NO_FUNCTION(GetNumberOfContinuousStates, (fmi3Instance c, size_t *n))
NO_FUNCTION(ActivateModelPartition,
            (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))
