/*
 * A step of a unit: its ticks, with the command and the motion of the load that it was given.
 *
 * A tick is that of a run: the supply fills pressures and feed, the actuator advances, then the
 * supply does, with the oil that the actuator drew and returned.
 */
#include "inside.h"

#include <stdio.h>
#include <string.h>

static const double TICK = STEP_NS / NS_PER_SECOND;
/* Parts of a tick by which sums of times may be off. */
#define MOST_OFF_SIZE 1e-6
#define MOST_OFF_TIME 1e-3
#define MOST_TICKS 1e9

/* Return whether an input has another value than when the last command was made, and keep it. */
static int has_changed(struct given *given, int input)
{
  const int is_other = given->inputs[input] != given->handed[input];
  given->handed[input] = given->inputs[input];
  return is_other;
}

static int is_new(const struct given *given, int input)
{
  return given->is_new[input];
}

/*
 * Return the command of a step: a setpoint if a number of it was written, a request if its input
 * has changed. A gain that was not written is that in force.
 */
static isa_command_t take_command(unit_t *unit)
{
  struct given *given = &unit->given;
  const double *in = given->inputs;
  isa_command_t command = isa_setpoint(in[IN_SETPOINT_POSITION], in[IN_SETPOINT_VELOCITY],
                                       in[IN_SETPOINT_EFFORT]);
  command.kinds = 0;
  command.mode = (int64_t)in[IN_MODE];
  command.is_enabled = in[IN_ENABLE] != 0.0;
  command.reference = in[IN_REFERENCE];
  if (is_new(given, IN_SETPOINT_STIFFNESS)) command.stiffness = in[IN_SETPOINT_STIFFNESS];
  if (is_new(given, IN_SETPOINT_DAMPING)) command.damping = in[IN_SETPOINT_DAMPING];
  if (is_new(given, IN_SETPOINT_POSITION) || is_new(given, IN_SETPOINT_VELOCITY) ||
      is_new(given, IN_SETPOINT_EFFORT))
    command.kinds |= ISA_SETPOINT;
  else if (is_new(given, IN_SETPOINT_STIFFNESS) || is_new(given, IN_SETPOINT_DAMPING))
    command.kinds |= ISA_GAINS;
  if (has_changed(given, IN_ENABLE)) command.kinds |= ISA_ENABLE;
  if (has_changed(given, IN_CLEAR_FAULT) && in[IN_CLEAR_FAULT] != 0.0)
    command.kinds |= ISA_CLEAR_FAULT;
  if (has_changed(given, IN_QUICK_STOP) && in[IN_QUICK_STOP] != 0.0)
    command.kinds |= ISA_QUICK_STOP;
  if (has_changed(given, IN_MODE)) command.kinds |= ISA_MODE;
  if (is_new(given, IN_REFERENCE) && command.mode <= ISA_MODE_PRESSURE)
    command.kinds |= ISA_REFERENCE;
  memset(given->is_new, 0, sizeof given->is_new);
  return command;
}

/* Put parameters that have changed in force; the valve current of loops that are on goes on. */
static void take_parameters(unit_t *unit)
{
  int has_any = 0;
  for (size_t k = 0; k < TUNED_COUNT; k++) {
    if (!has_changed(&unit->given, TUNED[k].input)) continue;
    ISA(put_number)(unit->actuator, TUNED[k].place, unit->given.inputs[TUNED[k].input]);
    has_any = 1;
  }
  if (has_any && *ISA(flag)(unit->actuator, IS_ON))
    *ISA(flag)(unit->actuator, FADE) = EVERY_BLOCK;
}

/* Fill the port as the load is `after` s behind the begin of the step. */
static void fill_port(unit_t *unit, double after)
{
#if HAS_PORT
  const double *in = unit->given.inputs + IN_PORT_POSITION;
  isa_port_t *port = AT(isa_port_t, unit, AT_PORT);
  memcpy(port, in, PORT_INPUTS * sizeof *in);
  port->x0 += after * (port->v0 + 0.5 * after * port->a0);
  port->v0 += after * port->a0;
  port->a_bias += after * port->jerk;
#else
  (void)unit;
  (void)after;
#endif
}

static void run(unit_t *unit, const struct call *calls, size_t n)
{
  for (size_t k = 0; k < n; k++) calls[k].run(unit->tables + calls[k].table);
}

/* Advance supply and actuator by one tick; return the code of the actuator. */
static int tick(unit_t *unit, const isa_command_t *command)
{
  int code;
  run(unit, BEFORE, BEFORE_COUNT);
  code = ISA(tick)(unit->actuator, AT(const isa_port_t, unit, AT_PORT),
                   HAS_FEED ? AT(const isa_feed_t, unit, AT_FEED) : NULL, command);
  if (code) return code;
  *AT(isa_reply_t, unit, AT_REPLY) = *ISA(reply)(unit->actuator);
  *AT(isa_fed_t, unit, AT_FED) = *ISA(fed)(unit->actuator);
  run(unit, AFTER, AFTER_COUNT);
  return 0;
}

/* Advance by the first tick of a step; a command that the actuator refuses is left out. */
static enum status first_tick(unit_t *unit, int *code)
{
  const isa_command_t command = take_command(unit);
  char message[UNIT_MESSAGE_BYTES];
  take_parameters(unit);
  fill_port(unit, 0.0);
  *code = tick(unit, command.kinds ? &command : NULL);
  if (*code >= 0) return STATUS_OK;
  snprintf(message, sizeof message, "t = %.9g s: the command is refused: %s", unit_time(unit),
           ISA(message)(*code));
  *code = tick(unit, NULL);
  return unit_say(unit, STATUS_WARNING, message);
}

/* Return the ticks of a step, or 0 if it cannot be made. */
static int64_t ticks_of(const unit_t *unit, double from, double size)
{
  char message[UNIT_MESSAGE_BYTES];
  const double off = from - unit_time(unit), ticks = size / TICK;
  const int64_t whole = is_finite(ticks) && ticks > 0.0 && ticks < MOST_TICKS
                          ? (int64_t)(ticks + 0.5) : 0;
  if (!(off <= MOST_OFF_TIME * TICK && off >= -MOST_OFF_TIME * TICK)) {
    snprintf(message, sizeof message, "a step from t = %.9g s, must be from %.9g s, where the "
             "last one ended", from, unit_time(unit));
  } else if (whole < 1 || ticks - whole > MOST_OFF_SIZE || whole - ticks > MOST_OFF_SIZE) {
    snprintf(message, sizeof message, "a step of %.9g s, must be a multiple of the tick, %.9g s",
             size, TICK);
  } else {
    return whole;
  }
  unit_say(unit, STATUS_ERROR, message);
  return 0;
}

enum status unit_step(unit_t *unit, double from, double size)
{
  char message[UNIT_MESSAGE_BYTES];
  enum status status;
  int64_t n;
  int code;
  if (unit->given.phase != RUNNING) return unit_refuse_phase(unit, "a step");
  if (!(n = ticks_of(unit, from, size))) return STATUS_ERROR;
  status = first_tick(unit, &code);
  for (int64_t k = 1; k < n && !code; k++) {
    fill_port(unit, k * TICK);
    code = tick(unit, NULL);
  }
  if (!code) return status;
  unit->given.phase = BROKEN;
  snprintf(message, sizeof message, "t = %.9g s: %s", unit_time(unit), ISA(message)(code));
  return unit_say(unit, STATUS_ERROR, message);
}
