/*
 * A unit by FMI 2.0 for co-simulation; what a fixed tick does not have is refused with a message.
 */
#include "fmi2.h"
#include "unit.h"

#include <stdlib.h>

/* The message is the logger's format: many importers show it without looking for arguments. */
static void report(const struct importer *own, enum status status, const char *category,
                   const char *message)
{
  char format[2 * UNIT_MESSAGE_BYTES], *to = format;
  if (!own->logger) return;
  for (const char *from = message; *from; from++) {
    if (*from == '%') *to++ = '%';
    *to++ = *from;
  }
  *to = 0;
  ((fmi2CallbackLogger)own->logger)(own->environment, own->name, (fmi2Status)status, category,
                                    format);
}

EXPORT const char *fmi2GetTypesPlatform(void)
{
  return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
  return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n,
                                      const fmi2String categories[])
{
  (void)c, (void)on, (void)n, (void)categories;
  return fmi2OK;    /* warnings and errors are always reported, and there is nothing else */
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token,
                                     fmi2String resources, const fmi2CallbackFunctions *functions,
                                     fmi2Boolean visible, fmi2Boolean logging)
{
  (void)resources, (void)visible, (void)logging;
  if (!name || !token || !functions) return NULL;
  const struct importer importer = {name, functions->componentEnvironment,
                                    (void (*)(void))functions->logger, report};
  return type == fmi2CoSimulation ? unit_create(&importer, token)
                                  : unit_refuse_creation(&importer, "model exchange");
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
  unit_free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance,
                                      fmi2Real tolerance, fmi2Real begin, fmi2Boolean has_end,
                                      fmi2Real end)
{
  (void)has_tolerance, (void)tolerance, (void)has_end, (void)end;
  return (fmi2Status)unit_set_begin(c, begin);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
  return (fmi2Status)unit_begin(c);
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
  return (fmi2Status)unit_end_begin(c);
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
  return (fmi2Status)unit_terminate(c);
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
  return (fmi2Status)unit_reset(c);
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                              fmi2Real value[])
{
  return (fmi2Status)unit_read(c, TYPE_REAL, vr, n, value);
}

/* Whole numbers and enumerations have one type in this version. */
static enum type whole(fmi2ValueReference vr)
{
  return unit_is_enumeration(vr) ? TYPE_ENUMERATION : TYPE_INTEGER;
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 fmi2Integer value[])
{
  for (size_t k = 0; k < n; k++) {
    int64_t found;
    if (unit_read_whole(c, whole(vr[k]), vr[k], &found) != STATUS_OK) return fmi2Error;
    value[k] = (fmi2Integer)found;
  }
  return fmi2OK;
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 fmi2Boolean value[])
{
  for (size_t k = 0; k < n; k++) {
    int64_t found;
    if (unit_read_whole(c, TYPE_BOOLEAN, vr[k], &found) != STATUS_OK) return fmi2Error;
    value[k] = found != 0;
  }
  return fmi2OK;
}

EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                fmi2String value[])
{
  for (size_t k = 0; k < n; k++)
    if (unit_read_text(c, vr[k], value + k) != STATUS_OK) return fmi2Error;
  return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                              const fmi2Real value[])
{
  return (fmi2Status)unit_write(c, TYPE_REAL, vr, n, value);
}

EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 const fmi2Integer value[])
{
  enum status status = STATUS_OK;
  for (size_t k = 0; k < n; k++) {
    const double given = value[k];
    const enum status own = unit_write(c, whole(vr[k]), vr + k, 1, &given);
    if (own > status) status = own;
  }
  return (fmi2Status)status;
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 const fmi2Boolean value[])
{
  enum status status = STATUS_OK;
  for (size_t k = 0; k < n; k++) {
    const double given = value[k] != 0;
    const enum status own = unit_write(c, TYPE_BOOLEAN, vr + k, 1, &given);
    if (own > status) status = own;
  }
  return (fmi2Status)status;
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                const fmi2String value[])
{
  (void)vr, (void)value;
  return n ? (fmi2Status)unit_refuse(c, "to set a text") : fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  (void)c;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi2OK;
}

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  return (fmi2Status)unit_get_state(c, state);
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
  return (fmi2Status)unit_set_state(c, state);
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
  (void)c, (void)state;
  *size = unit_state_size();
  return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                        size_t size)
{
  return (fmi2Status)unit_serialize(c, state, bytes, size);
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *state)
{
  return (fmi2Status)unit_deserialize(c, bytes, size, state);
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                               size_t n_unknown, const fmi2ValueReference known[],
                                               size_t n_known, const fmi2Real of_known[],
                                               fmi2Real of_unknown[])
{
  (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)of_known, (void)of_unknown;
  return (fmi2Status)unit_refuse(c, "a directional derivative");
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                              size_t n, const fmi2Integer order[],
                                              const fmi2Real value[])
{
  (void)vr, (void)n, (void)order, (void)value;
  return (fmi2Status)unit_refuse(c, "a derivative of an input");
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                               size_t n, const fmi2Integer order[],
                                               fmi2Real value[])
{
  (void)vr, (void)n, (void)order, (void)value;
  return (fmi2Status)unit_refuse(c, "a derivative of an output");
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real size, fmi2Boolean is_final)
{
  (void)is_final;
  return (fmi2Status)unit_step(c, from, size);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
  return (fmi2Status)unit_refuse(c, "to cancel a step");
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
  (void)kind, (void)value;
  unit_refuse(c, "a pending step");
  return fmi2Discard;
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
  if (kind == fmi2LastSuccessfulTime) {
    *value = unit_time(c);
    return fmi2OK;
  }
  unit_refuse(c, "this status");
  return fmi2Discard;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
  (void)kind, (void)value;
  unit_refuse(c, "this status");
  return fmi2Discard;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
{
  if (kind == fmi2Terminated) {
    *value = 0;
    return fmi2OK;
  }
  unit_refuse(c, "this status");
  return fmi2Discard;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
  (void)kind, (void)value;
  unit_refuse(c, "a pending step");
  return fmi2Discard;
}
