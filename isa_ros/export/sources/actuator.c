/*
 * @NAME@: what is not in its kernels.
 *
 * An instance is a block of memory that the kernels work on, and for each kernel a table with the
 * address and the lengths of every array in it. @NAME@_tables.h has the places in the block, what
 * it holds before a start, the ranges of numbers, and names. Nothing else is kept, so instances
 * share what is constant only.
 *
 *   cc -std=c11 -O2 -fPIC -fvisibility=hidden -ffreestanding -fno-stack-protector -shared -nostdlib
 *      -Wl,--version-script=@NAME@.map -o lib@NAME@.so @NAME@.c @NAME@_kernels.o
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>

struct word { int64_t value; int is_place; };
struct image { size_t place; uint64_t bits; };
struct part { size_t place, bytes; };
struct check { size_t at, count, bytes; int64_t largest; };
struct range { double low, high; };
enum { OF_POSITION, OF_VELOCITY, OF_EFFORT, OF_STIFFNESS, OF_DAMPING, OF_REFERENCES };

#include "@NAME@_tables.h"

#ifndef ISA_EXPORT
#define ISA_EXPORT __attribute__((visibility("default")))
#endif

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define AT(type, self, place) ((self) ? (const type *)((self)->block + (place)) : NULL)
#define ALIGNED 16
#define MIXER UINT64_C(0x9e3779b97f4a7c15)   /* odd: 2^64 over the golden ratio */
#define SAVED_FED (SAVED_TAIL + sizeof TAIL)
#define AT_CHECKSUM (SAVED_FED + sizeof(isa_fed_t))
#define STATE_BYTES (AT_CHECKSUM + sizeof(uint64_t))

_Static_assert(AT_CHECKSUM % sizeof(uint64_t) == 0, "a state is of whole words");

struct @NAME@ {
  const void *place;                    /* of the instance: a copy of it is none */
  int64_t diverged;                     /* what the last tick returned; 0: all is finite */
  int64_t tables[COUNT(WORDS)];
  _Alignas(ALIGNED) unsigned char block[BLOCK_BYTES];
};

/* The block is written and read as bytes: what it holds is of many types. */
static void copy(void *to, const void *from, size_t bytes)
{
  unsigned char *target = to;
  const unsigned char *source = from;
  for (size_t k = 0; k < bytes; k++) target[k] = source[k];
}

static int is_instance(const @NAME@_t *self)
{
  return self && self->place == self;
}

static int64_t whole_at(const @NAME@_t *self, size_t place)
{
  int64_t whole;
  copy(&whole, self->block + place, sizeof whole);
  return whole;
}

ISA_EXPORT const isa_about_t *ISA(about)(void)
{
  return &ABOUT;
}

ISA_EXPORT size_t ISA(size)(void)
{
  return sizeof(struct @NAME@);
}

ISA_EXPORT @NAME@_t *ISA(create)(void *memory, size_t bytes)
{
  @NAME@_t *self = memory;
  if (!memory || (uintptr_t)memory % ALIGNED || bytes < sizeof *self) return NULL;
  for (size_t k = 0; k < COUNT(WORDS); k++)
    self->tables[k] = WORDS[k].value + (WORDS[k].is_place ? (int64_t)(intptr_t)self->block : 0);
  self->place = self;
  ISA(start)(self, NULL);
  return self;
}

/* Return 0, or why an actuator cannot start so. */
static int check_start(const isa_start_t *start)
{
  if (!isfinite(start->position) || !isfinite(start->force) || !isfinite(start->supply_pressure) ||
      !isfinite(start->return_pressure))
    return ISA_NOT_FINITE;
  if (start->position < POSITION_LOW || start->position > POSITION_HIGH ||
      start->force < FORCE_LOW || start->force > FORCE_HIGH ||
      start->supply_pressure < VACUUM || start->return_pressure < VACUUM)
    return ISA_BEYOND_RANGE;
  return start->supply_pressure < start->return_pressure ? ISA_PRESSURES : ISA_OK;
}

/* Forget all that was, also what the kernels work on and no saved state has. */
static void clear(@NAME@_t *self)
{
  self->diverged = 0;
  for (size_t k = 0; k < BLOCK_BYTES; k++) self->block[k] = 0;
  for (size_t k = 0; k < COUNT(IMAGE); k++)
    copy(self->block + IMAGE[k].place, &IMAGE[k].bits, sizeof IMAGE[k].bits);
}

ISA_EXPORT int ISA(start)(@NAME@_t *self, const isa_start_t *start)
{
  const int code = start ? check_start(start) : ISA_OK;
  if (!is_instance(self)) return ISA_NO_INSTANCE;
  if (code) return code;
  if (!start) start = &ABOUT.start;
  clear(self);
  copy(self->block + AT_START, start, sizeof *start);
  if (HAS_OWN_LOAD)
    copy(self->block + AT_PORT_IN_FORCE + offsetof(isa_port_t, x0), &start->position,
         sizeof start->position);
  START_KERNEL(self->tables + START_TABLE);
  return ISA_OK;
}

/* Return 0, or why a number cannot be taken; limit it to its range where that is configured. */
static int check_number(double *value, struct range range)
{
  if (!isfinite(*value)) return ISA_NOT_FINITE;
  if (*value >= range.low && *value <= range.high) return ISA_OK;
  if (!LIMITS) return ISA_BEYOND_RANGE;
  *value = *value < range.low ? range.low : range.high;
  return ISA_OK;
}

/* Return 0, or why a setpoint cannot be taken; complete what its mode does not use and is NaN. */
static int check_setpoint(const @NAME@_t *self, isa_command_t *own, int64_t mode)
{
  int code;
  if (mode != ISA_MODE_POSITION && mode != ISA_MODE_IMPEDANCE) {
    if (isnan(own->position))
      copy(&own->position, self->block + AT_SETPOINT_POSITION, sizeof own->position);
    if (isnan(own->velocity)) own->velocity = 0.0;
  }
  if (mode == ISA_MODE_POSITION && isnan(own->effort)) own->effort = 0.0;
  code = check_number(&own->position, RANGES[OF_POSITION]);
  if (!code) code = check_number(&own->velocity, RANGES[OF_VELOCITY]);
  if (!code) code = check_number(&own->effort, RANGES[OF_EFFORT]);
  return code;
}

static int check_gains(isa_command_t *own)
{
  int code = ISA_OK;
  if (!isnan(own->stiffness)) code = check_number(&own->stiffness, RANGES[OF_STIFFNESS]);
  if (!code && !isnan(own->damping)) code = check_number(&own->damping, RANGES[OF_DAMPING]);
  return code;
}

/* Return 0, or why a command cannot be taken. */
static int check_command(const @NAME@_t *self, isa_command_t *own)
{
  const int64_t mode = own->kinds & ISA_MODE ? own->mode : whole_at(self, AT_MODE);
  int code = ISA_OK;
  if (own->kinds & ~(uint32_t)EVERY_KIND || own->is_enabled > 1) return ISA_UNKNOWN_KIND;
  if (own->kinds & (ISA_MODE | ISA_REFERENCE) &&
      (own->mode < 0 || own->mode > ISA_MODE_IMPEDANCE || !(POSSIBLE_MODES >> own->mode & 1)))
    return ISA_UNKNOWN_MODE;
  if (own->kinds & ISA_REFERENCE && (own->mode != mode || !(REFERENCES >> own->mode & 1)))
    return ISA_WRONG_MODE;
  if (own->kinds & ISA_SETPOINT) code = check_setpoint(self, own, mode);
  if (!code && own->kinds & (ISA_SETPOINT | ISA_GAINS)) code = check_gains(own);
  if (!code && own->kinds & ISA_REFERENCE)
    code = check_number(&own->reference, RANGES[OF_REFERENCES + own->mode]);
  return code;
}

static int are_finite(const void *values, size_t bytes)
{
  const double *own = values;
  for (size_t k = 0; k < bytes / sizeof *own; k++)
    if (!isfinite(own[k])) return 0;
  return 1;
}

/* Return 0, or why a feed cannot be taken. */
static int check_feed(const isa_feed_t *feed)
{
  if (!are_finite(feed, sizeof *feed)) return ISA_NOT_FINITE;
  return feed->is_warm > 0.0 && feed->celsius < COLDEST ? ISA_BEYOND_RANGE : ISA_OK;
}

/* Return 0, or why a port cannot be taken. */
static int check_port(const isa_port_t *port)
{
  if (!are_finite(port, sizeof *port)) return ISA_NOT_FINITE;
  return port->supply_pressure < VACUUM || port->return_pressure < VACUUM ||
         port->inverse_mass < 0.0 ||
         (!HAS_OWN_LOAD && (port->x0 < LOAD_LOW || port->x0 > LOAD_HIGH)) ? ISA_BEYOND_RANGE : ISA_OK;
}

ISA_EXPORT int ISA(tick)(@NAME@_t *self, const isa_port_t *port, const isa_feed_t *feed,
                         const isa_command_t *command)
{
  static const isa_command_t none;
  static const isa_feed_t held;
  isa_command_t own = command ? *command : none;
  int code = ISA_OK;
  if (!is_instance(self) || !(port || HAS_OWN_LOAD)) return ISA_NO_INSTANCE;
  if (self->diverged) return (int)self->diverged;
  if (port) code = check_port(port);
  if (!code && feed) code = check_feed(feed);
  if (!code) code = check_command(self, &own);
  if (code) return code;
  copy(self->block + AT_PORT, port ? (const void *)port : self->block + AT_PORT_IN_FORCE,
       sizeof *port);
  copy(self->block + AT_FEED, feed ? feed : &held, sizeof *feed);
  copy(self->block + AT_COMMAND, &own, sizeof own);
  self->diverged = TICK_KERNEL(self->tables + TICK_TABLE);
  return (int)self->diverged;
}

ISA_EXPORT double ISA(load_position)(const @NAME@_t *self)
{
  double position;
  if (!self) return NAN;
  copy(&position, self->block + AT_LOAD_POSITION, sizeof position);
  return position;
}

ISA_EXPORT const isa_sample_t *ISA(sample)(const @NAME@_t *self)
{
  return AT(isa_sample_t, self, AT_SAMPLE);
}

ISA_EXPORT const isa_reply_t *ISA(reply)(const @NAME@_t *self)
{
  return AT(isa_reply_t, self, AT_REPLY);
}

ISA_EXPORT const isa_fed_t *ISA(fed)(const @NAME@_t *self)
{
  return AT(isa_fed_t, self, AT_FED);
}

ISA_EXPORT const isa_command_t *ISA(applied)(const @NAME@_t *self)
{
  return AT(isa_command_t, self, AT_APPLIED);
}

ISA_EXPORT int64_t ISA(time_ns)(const @NAME@_t *self)
{
  return self ? whole_at(self, AT_CLOCK) * PLANT_STEP_NS : 0;
}

ISA_EXPORT size_t ISA(state_size)(void)
{
  return STATE_BYTES;
}

/* Return whether the numbers of a state are finite, and whole ones in the range that kernels use. */
static int are_possible(const unsigned char *state)
{
  for (size_t k = 0; k < COUNT(CHECKS); k++) {
    const struct check own = CHECKS[k];
    for (size_t at = own.at; at < own.at + own.count * own.bytes; at += own.bytes) {
      int64_t whole = 0;
      double value;
      copy(&whole, state + at, own.bytes);
      copy(&value, &whole, sizeof value);
      if (own.largest == OF_FLOAT ? !isfinite(value)
          : own.largest == OF_GAIN ? isinf(value)
          : whole < 0 || whole > own.largest)
        return 0;
    }
  }
  return 1;
}

/*
 * Return the checksum of whole words. Each step maps sums one to one, so that a change within 8
 * bytes always changes it.
 */
uint64_t ISA(checksum)(const unsigned char *state, size_t bytes);

uint64_t ISA(checksum)(const unsigned char *state, size_t bytes)
{
  uint64_t sum = 0, word;
  for (size_t at = 0; at < bytes; at += sizeof word) {
    copy(&word, state + at, sizeof word);
    sum = (sum ^ word) * MIXER;
    sum ^= sum >> 32;
  }
  return sum;
}

ISA_EXPORT int ISA(save)(const @NAME@_t *self, void *state, size_t bytes)
{
  const int64_t t_ns = ISA(time_ns)(self);
  unsigned char *to = state;
  uint64_t sum;
  if (!is_instance(self) || !state) return ISA_NO_INSTANCE;
  if (bytes != STATE_BYTES) return ISA_WRONG_SIZE;
  copy(to, &t_ns, sizeof t_ns);
  to += sizeof t_ns;
  for (size_t k = 0; k < COUNT(SAVED); k++) {
    copy(to, self->block + SAVED[k].place, SAVED[k].bytes);
    to += SAVED[k].bytes;
  }
  copy(to, TAIL, sizeof TAIL);
  copy(to + sizeof TAIL, self->block + AT_FED, sizeof(isa_fed_t));
  sum = ISA(checksum)(state, AT_CHECKSUM);
  copy(to + sizeof TAIL + sizeof(isa_fed_t), &sum, sizeof sum);
  return are_possible(state) ? ISA_OK : ISA_NOT_FINITE;
}

/* Return 0, or why bytes are not a state of this actuator. */
static int check_state(const unsigned char *state)
{
  int64_t t_ns;
  uint64_t sum;
  copy(&t_ns, state, sizeof t_ns);
  copy(&sum, state + AT_CHECKSUM, sizeof sum);
  for (size_t k = 0; k < sizeof TAIL; k++)
    if (state[SAVED_TAIL + k] != TAIL[k]) return ISA_WRONG_STATE;
  if (sum != ISA(checksum)(state, AT_CHECKSUM)) return ISA_WRONG_STATE;
  if (t_ns < 0 || t_ns % STEP_NS || t_ns / STEP_NS >= MAX_TICKS) return ISA_WRONG_STATE;
  return are_possible(state) ? ISA_OK : ISA_WRONG_STATE;
}

ISA_EXPORT int ISA(restore)(@NAME@_t *self, const void *state, size_t bytes)
{
  const unsigned char *from = state;
  int64_t t_ns;
  int code;
  if (!is_instance(self) || !state) return ISA_NO_INSTANCE;
  if (bytes != STATE_BYTES) return ISA_WRONG_SIZE;
  code = check_state(from);
  if (code) return code;
  clear(self);
  copy(&t_ns, from, sizeof t_ns);
  t_ns /= PLANT_STEP_NS;
  copy(self->block + AT_CLOCK, &t_ns, sizeof t_ns);
  from += sizeof t_ns;
  for (size_t k = 0; k < COUNT(SAVED); k++) {
    copy(self->block + SAVED[k].place, from, SAVED[k].bytes);
    from += SAVED[k].bytes;
  }
  copy(self->block + AT_FED, from + sizeof TAIL, sizeof(isa_fed_t));
  if (!HAS_LINK)
    copy(self->block + AT_SAMPLE, self->block + AT_OWN_SAMPLE, sizeof(isa_sample_t));
  return ISA_OK;
}

ISA_EXPORT int ISA(field_count)(void)
{
  return COUNT(FIELDS);
}

ISA_EXPORT const isa_field_t *ISA(field)(int index)
{
  return index >= 0 && index < (int)COUNT(FIELDS) ? FIELDS + index : NULL;
}

ISA_EXPORT int ISA(parameter_count)(void)
{
  return COUNT(PARAMETERS);
}

ISA_EXPORT const isa_parameter_t *ISA(parameter)(int index)
{
  return index >= 0 && index < (int)COUNT(PARAMETERS) ? PARAMETERS + index : NULL;
}

ISA_EXPORT const isa_parameter_t *ISA(find)(const char *name)
{
  for (size_t k = 0; name && k < COUNT(PARAMETERS); k++) {
    const char *own = PARAMETERS[k].name, *other = name;
    while (*own && *own == *other) own++, other++;
    if (*own == *other) return PARAMETERS + k;
  }
  return NULL;
}

ISA_EXPORT const char *ISA(message)(int code)
{
  if (code > 0 && code <= (int)COUNT(STATE_NAMES)) return STATE_NAMES[code - 1];
  switch (code) {
    case ISA_OK: return "done";
    case ISA_NO_INSTANCE: return "no instance was created in this memory, or a pointer is NULL";
    case ISA_NOT_FINITE: return "a number is not finite";
    case ISA_BEYOND_RANGE: return "a number of the setpoint, start, port or feed is beyond its range";
    case ISA_UNKNOWN_KIND: return "kinds or is_enabled of the command do not exist";
    case ISA_UNKNOWN_MODE: return "the actuator does not have this mode";
    case ISA_WRONG_MODE: return "the reference is not of the mode in force";
    case ISA_PRESSURES: return "the return has a higher pressure than the supply";
    case ISA_WRONG_SIZE: return "a saved state has another number of bytes";
    case ISA_WRONG_STATE: return "the bytes are not a state of this actuator, or damaged";
    default: return "unknown code";
  }
}
