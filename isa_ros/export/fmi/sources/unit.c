/* The life of a unit, and the values of its variables. */
#include "inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void say(const struct importer *importer, enum status status, const char *message)
{
  static const char *const CATEGORIES[] = {"logStatusOK", "logStatusWarning", "logStatusDiscard",
                                           "logStatusError"};
  importer->report(importer, status, CATEGORIES[status], message);
}

enum status unit_say(const unit_t *unit, enum status status, const char *message)
{
  say(&unit->importer, status, message);
  return status;
}

static enum status worse(enum status one, enum status other)
{
  return one > other ? one : other;
}

unit_t *unit_refuse_creation(const struct importer *importer, const char *what)
{
  char message[UNIT_MESSAGE_BYTES];
  snprintf(message, sizeof message, "%s is not possible with this unit", what);
  say(importer, STATUS_ERROR, message);
  return NULL;
}

enum status unit_refuse(const unit_t *unit, const char *what)
{
  unit_refuse_creation(&unit->importer, what);
  return STATUS_ERROR;
}

enum status unit_refuse_phase(const unit_t *unit, const char *what)
{
  static const char *const PHASES[] = {
    "before its initialization", "in its initialization", "after its initialization",
    "when it has ended", "after its state has diverged"};
  char message[UNIT_MESSAGE_BYTES];
  snprintf(message, sizeof message, "%s is not possible %s", what, PHASES[unit->given.phase]);
  return unit_say(unit, STATUS_ERROR, message);
}

void unit_begin_supply(unit_t *unit)
{
  memcpy(unit->supply, SUPPLY_IMAGE, sizeof unit->supply);
  for (size_t k = 0; k < SUPPLY_WORDS; k++)
    unit->tables[k] = WORDS[k].is_place ? (int64_t)(intptr_t)(unit->supply + WORDS[k].value)
                                        : WORDS[k].value;
}

/* Let positions that were not written be those of the actuator at rest: no force jumps. */
static void follow_start(unit_t *unit)
{
  struct given *given = &unit->given;
  if (!given->is_new[IN_SETPOINT_POSITION])
    given->inputs[IN_SETPOINT_POSITION] = given->inputs[IN_START_POSITION];
#if HAS_PORT
  if (!given->is_new[IN_PORT_POSITION])
    given->inputs[IN_PORT_POSITION] = ISA(load_position)(unit->actuator);
#endif
}

/* Put actuator and supply at rest as the parameters say. */
static enum status start(unit_t *unit)
{
  const double *inputs = unit->given.inputs;
  unit_begin_supply(unit);
  const supply_sample_t *supply = AT(const supply_sample_t, unit, AT_SUPPLY);
  const isa_start_t at = {inputs[IN_START_POSITION], inputs[IN_START_FORCE], supply->pressure,
                          supply->return_pressure};
  const int code = ISA(start)(unit->actuator, &at);
  if (code) return unit_say(unit, STATUS_ERROR, ISA(message)(code));
  follow_start(unit);
  return STATUS_OK;
}

static void set_default(unit_t *unit)
{
  memset(&unit->given, 0, sizeof unit->given);
  memcpy(unit->given.inputs, DEFAULTS, sizeof DEFAULTS);
  memcpy(unit->given.handed, DEFAULTS, sizeof DEFAULTS);
}

unit_t *unit_create(const struct importer *importer, const char *token)
{
  const size_t own = (sizeof(unit_t) + 63) / 64 * 64, actuator = (ISA(size)() + 63) / 64 * 64;
  const size_t name = strlen(importer->name) + 1;
  unit_t *unit;
  if (strcmp(token, TOKEN) != 0)
    return unit_refuse_creation(importer, "another token (guid) than " TOKEN);
  unit = calloc(1, own + actuator + name);
  if (!unit) return NULL;
  unit->importer = *importer;
  unit->importer.name = memcpy((char *)unit + own + actuator, importer->name, name);
  unit->actuator = ISA(create)((char *)unit + own, ISA(size)());
  set_default(unit);
  if (!unit->actuator || start(unit) != STATUS_OK) {
    free(unit);
    return NULL;
  }
  return unit;
}

void unit_free(unit_t *unit)
{
  free(unit);
}

enum status unit_reset(unit_t *unit)
{
  set_default(unit);
  return start(unit);
}

enum status unit_set_begin(unit_t *unit, double time)
{
  if (unit->given.phase != CREATED) return unit_refuse_phase(unit, "to set the time of the start");
  if (!is_finite(time)) return unit_say(unit, STATUS_ERROR, "the time of the start is not finite");
  unit->given.begin = time;
  return STATUS_OK;
}

enum status unit_begin(unit_t *unit)
{
  if (unit->given.phase != CREATED) return unit_refuse_phase(unit, "to begin the initialization");
  unit->given.phase = BEGINNING;
  return start(unit);
}

enum status unit_end_begin(unit_t *unit)
{
  if (unit->given.phase != BEGINNING) return unit_refuse_phase(unit, "to end the initialization");
  unit->given.phase = RUNNING;
  return STATUS_OK;
}

enum status unit_terminate(unit_t *unit)
{
  if (unit->given.phase != RUNNING && unit->given.phase != BROKEN)
    return unit_refuse_phase(unit, "to end");
  unit->given.phase = TERMINATED;
  return STATUS_OK;
}

double unit_time(const unit_t *unit)
{
  return unit->given.begin + ISA(time_ns)(unit->actuator) / NS_PER_SECOND;
}

/* Return the variable of a reference that has a type, or NULL. */
static const struct variable *find(const unit_t *unit, enum type type, uint32_t reference)
{
  static const char *const TYPES[] = {"a number", "a whole number", "a boolean", "an enumeration",
                                      "a text"};
  char message[UNIT_MESSAGE_BYTES];
  if (reference < VARIABLE_COUNT && VARIABLES[reference].type == type)
    return VARIABLES + reference;
  if (reference < VARIABLE_COUNT)
    snprintf(message, sizeof message, "%s is %s, must be %s", VARIABLES[reference].name,
             TYPES[VARIABLES[reference].type], TYPES[type]);
  else
    snprintf(message, sizeof message, "value reference %lu, must be < %d",
             (unsigned long)reference, VARIABLE_COUNT);
  unit_say(unit, STATUS_ERROR, message);
  return NULL;
}

static double number_of(const unit_t *unit, const struct variable *own)
{
  switch (own->home) {
  case HOME_TIME: return unit_time(unit);
  case HOME_INPUT: return unit->given.inputs[own->place];
  case HOME_SAMPLE: return ((const double *)ISA(sample)(unit->actuator))[own->place];
  case HOME_REPLY: return ((const double *)ISA(reply)(unit->actuator))[own->place];
  case HOME_SUPPLY: return AT(const double, unit, AT_SUPPLY)[own->place];
  default: return NUMBERS[own->place];
  }
}

enum status unit_read(const unit_t *unit, enum type type, const uint32_t *references, size_t n,
                      double *values)
{
  for (size_t k = 0; k < n; k++) {
    const struct variable *own = find(unit, type, references[k]);
    if (!own) return STATUS_ERROR;
    values[k] = number_of(unit, own);
  }
  return STATUS_OK;
}

enum status unit_read_whole(const unit_t *unit, enum type type, uint32_t reference, int64_t *value)
{
  double found = 0.0;
  const enum status status = unit_read(unit, type, &reference, 1, &found);
  *value = (int64_t)found;
  return status;
}

int unit_is_enumeration(uint32_t reference)
{
  return reference < VARIABLE_COUNT && VARIABLES[reference].type == TYPE_ENUMERATION;
}

enum status unit_read_text(const unit_t *unit, uint32_t reference, const char **text)
{
  const struct variable *own = find(unit, TYPE_TEXT, reference);
  if (!own) return STATUS_ERROR;
  *text = TEXTS[own->place];
  return STATUS_OK;
}

/* Say what is wrong with a value: "name = 2 m, must be 0 to 0.1 m, what happens". */
static enum status say_range(const unit_t *unit, enum status status, const struct variable *own,
                             double value, const char *then)
{
  char message[UNIT_MESSAGE_BYTES], range[UNIT_MESSAGE_BYTES / 4];
  const char *space = *own->unit ? " " : "";
  if (!is_finite(value))
    snprintf(range, sizeof range, "finite");
  else if (own->place == IN_MODE)
    snprintf(range, sizeof range, "%s", MODE_NAMES);
  else if (is_finite(own->high))
    snprintf(range, sizeof range, "%g to %g%s%s", own->low, own->high, space, own->unit);
  else
    snprintf(range, sizeof range, ">= %g%s%s", own->low, space, own->unit);
  snprintf(message, sizeof message, "%s = %g%s%s, must be %s; %s", own->name, value, space,
           own->unit, range, then);
  return unit_say(unit, status, message);
}

static enum status say_fixed(const unit_t *unit, const struct variable *own)
{
  char message[UNIT_MESSAGE_BYTES];
  snprintf(message, sizeof message, "%s is computed or constant, it cannot be set", own->name);
  return unit_say(unit, STATUS_ERROR, message);
}

static enum status write_one(unit_t *unit, const struct variable *own, double value)
{
  const int is_start = own->home == HOME_INPUT && own->place >= IN_START_POSITION &&
                       own->place <= IN_START_FORCE;
  enum status status = STATUS_OK;
  if (own->home != HOME_INPUT) return say_fixed(unit, own);
  if (is_start && unit->given.phase > BEGINNING) return unit_refuse_phase(unit, own->name);
  if (!is_finite(value))
    return say_range(unit, STATUS_DISCARD, own, value, "the value before stays");
  if (own->place == IN_MODE && !has_mode(value))
    return say_range(unit, STATUS_WARNING, own, value, "the value before stays");
  if (value < own->low || value > own->high) {
    if (is_start) return say_range(unit, STATUS_ERROR, own, value, "the value before stays");
    if (!LIMITS) return say_range(unit, STATUS_WARNING, own, value, "the value before stays");
    status = say_range(unit, STATUS_WARNING, own, value, "limited");
    value = value < own->low ? own->low : own->high;
  }
  unit->given.inputs[own->place] = value;
  unit->given.is_new[own->place] = 1;
  return is_start && unit->given.phase == BEGINNING ? worse(status, start(unit)) : status;
}

enum status unit_write(unit_t *unit, enum type type, const uint32_t *references, size_t n,
                       const double *values)
{
  enum status status = STATUS_OK;
  for (size_t k = 0; k < n; k++) {
    const struct variable *own = find(unit, type, references[k]);
    status = worse(status, own ? write_one(unit, own, values[k]) : STATUS_ERROR);
  }
  return status;
}
