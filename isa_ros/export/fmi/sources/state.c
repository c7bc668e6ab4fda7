/*
 * The state of a unit as bytes: the token, what is given, the supply, the actuator, and a checksum
 * of the words before it.
 */
#include "inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the supply: its sample, and what the actuator answered last. */
static const struct part {
  int32_t place, bytes;
} SUPPLY_STATE[] = {{AT_SUPPLY, sizeof(supply_sample_t)}, {AT_ANSWERS, ANSWER_BYTES}};

#define PARTS (sizeof SUPPLY_STATE / sizeof *SUPPLY_STATE)

/* Return the bytes of a state before its checksum: whole words, of which the last may be filled. */
static size_t summed(void)
{
  size_t bytes = sizeof TOKEN + sizeof(struct given) + ISA(state_size)();
  for (size_t k = 0; k < PARTS; k++) bytes += (size_t)SUPPLY_STATE[k].bytes;
  return (bytes + sizeof(uint64_t) - 1) / sizeof(uint64_t) * sizeof(uint64_t);
}

size_t unit_state_size(void)
{
  return summed() + sizeof(uint64_t);
}

static enum status save(const unit_t *unit, unsigned char *state)
{
  const size_t size = ISA(state_size)();
  unsigned char *const end = state + summed();
  const unsigned char *const begin = state;
  uint64_t sum;
  int code;
  memcpy(state, TOKEN, sizeof TOKEN);
  state += sizeof TOKEN;
  memcpy(state, &unit->given, sizeof unit->given);
  state += sizeof unit->given;
  for (size_t k = 0; k < PARTS; k++) {
    memcpy(state, unit->supply + SUPPLY_STATE[k].place, (size_t)SUPPLY_STATE[k].bytes);
    state += SUPPLY_STATE[k].bytes;
  }
  code = ISA(save)(unit->actuator, state, size);
  state += size;
  memset(state, 0, (size_t)(end - state));
  sum = ISA(checksum)(begin, summed());
  memcpy(end, &sum, sizeof sum);
  return code ? unit_say(unit, STATUS_ERROR, ISA(message)(code)) : STATUS_OK;
}

/* Return whether bytes could be what is given. */
static int is_possible(const struct given *given)
{
  if (given->phase < CREATED || given->phase > BROKEN || !is_finite(given->begin)) return 0;
  for (int k = 0; k < INPUTS; k++)
    if (!is_finite(given->inputs[k]) || !is_finite(given->handed[k])) return 0;
  return has_mode(given->inputs[IN_MODE]);
}

/* Return whether the n bytes are finite numbers. */
static int are_finite(const unsigned char *bytes, size_t n)
{
  double value;
  for (size_t k = 0; k + sizeof value <= n; k += sizeof value) {
    memcpy(&value, bytes + k, sizeof value);
    if (!is_finite(value)) return 0;
  }
  return 1;
}

static enum status restore(unit_t *unit, const unsigned char *state)
{
  static const char *const REFUSED = "the bytes are not a state of this unit";
  struct given given;
  const unsigned char *supply = state + sizeof TOKEN + sizeof given, *actuator = supply;
  uint64_t sum;
  int code;
  for (size_t k = 0; k < PARTS; k++) actuator += SUPPLY_STATE[k].bytes;
  memcpy(&sum, state + summed(), sizeof sum);
  if (memcmp(state, TOKEN, sizeof TOKEN) != 0 || sum != ISA(checksum)(state, summed()))
    return unit_say(unit, STATUS_ERROR, REFUSED);
  memcpy(&given, state + sizeof TOKEN, sizeof given);
  if (!is_possible(&given) || !are_finite(supply, (size_t)(actuator - supply)))
    return unit_say(unit, STATUS_ERROR, REFUSED);
  code = ISA(restore)(unit->actuator, actuator, ISA(state_size)());
  if (code) return unit_say(unit, STATUS_ERROR, ISA(message)(code));
  unit->given = given;
  for (size_t k = 0; k < TUNED_COUNT; k++)
    ISA(put_number)(unit->actuator, TUNED[k].place, given.handed[TUNED[k].input]);
  unit_begin_supply(unit);
  for (size_t k = 0; k < PARTS; k++) {
    memcpy(unit->supply + SUPPLY_STATE[k].place, supply, (size_t)SUPPLY_STATE[k].bytes);
    supply += SUPPLY_STATE[k].bytes;
  }
  return STATUS_OK;
}

/* Return memory for a state, or NULL with a message. */
static void *new_state(const unit_t *unit)
{
  void *found = malloc(unit_state_size());
  if (!found) unit_say(unit, STATUS_ERROR, "there is no memory for a state");
  return found;
}

enum status unit_get_state(const unit_t *unit, void **state)
{
  if (!*state && !(*state = new_state(unit))) return STATUS_ERROR;
  return save(unit, *state);
}

enum status unit_set_state(unit_t *unit, const void *state)
{
  if (!state) return unit_refuse(unit, "a state that is NULL");
  return restore(unit, state);
}

/* Return whether there are a state and bytes of its size, else say so. */
static int has_size(const unit_t *unit, const void *state, size_t size)
{
  char message[UNIT_MESSAGE_BYTES];
  if (state && size == unit_state_size()) return 1;
  snprintf(message, sizeof message, "a state of %lu bytes, must be %lu",
           (unsigned long)(state ? size : 0), (unsigned long)unit_state_size());
  unit_say(unit, STATUS_ERROR, message);
  return 0;
}

enum status unit_serialize(const unit_t *unit, const void *state, void *bytes, size_t size)
{
  if (!has_size(unit, state, size)) return STATUS_ERROR;
  memcpy(bytes, state, size);
  return STATUS_OK;
}

enum status unit_deserialize(const unit_t *unit, const void *bytes, size_t size, void **state)
{
  if (!has_size(unit, bytes, size)) return STATUS_ERROR;
  if (!*state && !(*state = new_state(unit))) return STATUS_ERROR;
  memcpy(*state, bytes, size);
  return STATUS_OK;
}
