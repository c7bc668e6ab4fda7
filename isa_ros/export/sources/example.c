/*
 * @NAME@ for one second: a step of its setpoint, a load of its own or of this program, and a state
 * that is saved and restored.
 *
 *   cc -std=c99 example.c -L. -l@NAME@ -Wl,-rpath,'$ORIGIN' -o example && ./example [SAMPLES]
 *
 * SAMPLES is a file for all samples as they are in memory.
 */
#include "@NAME@.h"

#include <stdio.h>
#include <stdlib.h>

/* The load of this program: a mass, or inertia, that only the actuator moves. */
struct mass {
  double inertia;     /* kg | kg m2 */
  double position;    /* m | rad */
  double velocity;    /* m/s | rad/s */
};

static isa_port_t port_of(const struct mass *load, const isa_start_t *supply)
{
  isa_port_t port = {0};
  port.x0 = load->position;
  port.v0 = load->velocity;
  port.inverse_mass = 1.0 / load->inertia;
  port.supply_pressure = supply->supply_pressure;
  port.return_pressure = supply->return_pressure;
  return port;
}

/* Move the mass by a tick with the mean force of each fifth of it. */
static void advance(struct mass *load, const isa_reply_t *reply, double tick)
{
  const double h = tick / 5;
  for (int k = 0; k < 5; k++) {
    const double acceleration = reply->mean_forces[k] / load->inertia;
    load->position += h * (load->velocity + h / 2 * acceleration);
    load->velocity += h * acceleration;
  }
}

int main(int argc, char **argv)
{
  const isa_about_t *about = @NAME@_about();
  const double tick = 1e-9 * (double)about->step_ns;
  const long ticks = (long)(1000000000 / about->step_ns);
  const double step = about->is_rotary ? 0.1 : 0.005;
  struct mass load = {about->is_rotary ? 0.5 : 50.0, 0.0, 0.0};
  FILE *file = argc > 1 ? fopen(argv[1], "wb") : NULL;
  @NAME@_t *actuator = @NAME@_create(malloc(@NAME@_size()), @NAME@_size());
  void *state = malloc(@NAME@_state_size());
  if (!actuator || !state || (argc > 1 && !file)) return 1;
  load.position = @NAME@_load_position(actuator);

  printf("%s, model %s, isa_ros %s, %d parameters\n", about->name, about->model, about->version,
         @NAME@_parameter_count());
  for (long k = 0; k < ticks; k++) {
    const isa_port_t port = port_of(&load, &about->start);
    isa_command_t command = {0};
    int code;
    if (file) fwrite(@NAME@_sample(actuator), sizeof(isa_sample_t), 1, file);
    if (k == ticks / 10) command = isa_setpoint(about->start.position + step, 0.0, 0.0);
    if (k == ticks / 2) command = isa_setpoint(about->start.position, 0.0, 0.0);
    code = @NAME@_tick(actuator, &port, NULL, &command);
    if (code) {
      fprintf(stderr, "tick %ld: %s\n", k, @NAME@_message(code));
      return 1;
    }
    advance(&load, @NAME@_reply(actuator), tick);
    if (k % (ticks / 10) == 0)
      printf("%6.3f s  position %8.5f  force %9.2f\n", 1e-9 * (double)@NAME@_time_ns(actuator),
             @NAME@_sample(actuator)->position, @NAME@_sample(actuator)->force);
  }
  if (file) {
    fwrite(@NAME@_sample(actuator), sizeof(isa_sample_t), 1, file);
    fclose(file);
  }

  if (@NAME@_save(actuator, state, @NAME@_state_size()) ||
      @NAME@_restore(actuator, state, @NAME@_state_size()))
    return 1;
  free(state);
  free(actuator);
  return 0;
}
