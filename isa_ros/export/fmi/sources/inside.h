/*
 * The inside of a unit, for the files that are its parts.
 *
 * tables.h, made by `isa export`, has the variables, and the memory of the supply.
 */
#ifndef ISA_INSIDE_H
#define ISA_INSIDE_H

#include "unit.h"

#include "tables.h"

#define NS_PER_SECOND 1e9

enum phase { CREATED, BEGINNING, RUNNING, TERMINATED, BROKEN };

/* What an instance is besides actuator and supply; a saved state has it as it is. */
struct given {
  double inputs[INPUTS];
  double handed[INPUTS];           /* when the last command was made */
  double begin;                    /* time of the first tick, s */
  int32_t phase;
  unsigned char is_new[INPUTS];    /* written since the last step */
};

struct unit {
  struct importer importer;
  ISA(t) * actuator;
  struct given given;
  int64_t tables[SUPPLY_WORDS];
  _Alignas(SUPPLY_ALIGNED) unsigned char supply[SUPPLY_BYTES];
};

#define AT(type, unit, place) ((type *)((unit)->supply + (place)))

static inline int is_finite(double value)
{
  return value - value == 0.0;
}

/* Return whether the actuator has a mode of a number. */
static inline int has_mode(double number)
{
  return number >= 0.0 && number <= ISA_MODE_IMPEDANCE && MODES >> (int)number & 1;
}

/* Hand a message to the importer; return its status. */
enum status unit_say(const unit_t *unit, enum status status, const char *message);

/* Say that something is not possible in the phase that the unit is in. */
enum status unit_refuse_phase(const unit_t *unit, const char *what);

/* Put the supply at t = 0, with its tables at its own addresses. */
void unit_begin_supply(unit_t *unit);

#endif
