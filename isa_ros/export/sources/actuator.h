/*
 * @NAME@: @ABOUT@.@ASSUMED@
 *
 * The model of the actuator with its sensors and its controller (REU), as isa_ros @VERSION@ has it,
 * as a library without dependencies. C99, C11 or C++11; docs/export.md has examples.
 *
 * Units are SI: m, N, kg of a linear actuator, rad, Nm, kg m2 of a rotary one ("m | rad"); Pa gauge.
 * Extending and pushing out are positive. Time is whole ticks of @NAME@_about()->step_ns.
 *
 * Instances are independent: threads may use different ones at the same time, and one of them
 * one after the other. No function allocates, locks, prints or keeps a pointer to an argument, but
 * @NAME@_create() to its memory. Functions that return an int return ISA_OK, or change nothing and
 * return a code of isa_code; @NAME@_tick() returns a number > 0 where the model has diverged.
 */
#ifndef @GUARD@_H
#define @GUARD@_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Types that all exported actuators share. */
#ifndef ISA_ACTUATOR_TYPES
#define ISA_ACTUATOR_TYPES @TYPES@   /* changes with every type below */

enum isa_code {
  ISA_OK = 0,
  ISA_NO_INSTANCE = -1,    /* no instance was created in this memory, or a pointer is NULL */
  ISA_NOT_FINITE = -2,     /* a number is NaN or infinite */
  ISA_BEYOND_RANGE = -3,   /* a number of a setpoint, start, port or feed is beyond its range */
  ISA_UNKNOWN_KIND = -4,   /* bits of a command, or its is_enabled, that do not exist */
  ISA_UNKNOWN_MODE = -5,   /* a mode that does not exist, or that this actuator does not have */
  ISA_WRONG_MODE = -6,     /* a reference of another mode than the one in force */
  ISA_PRESSURES = -7,      /* at the start, the return has a higher pressure than the supply */
  ISA_WRONG_SIZE = -8,     /* a saved state has another number of bytes */
  ISA_WRONG_STATE = -9     /* bytes that are not a state of this actuator, or damaged */
};

/* What a command has, bits of isa_command.kinds; several may be together. */
enum isa_kind {
  ISA_SETPOINT = 1,        /* position, velocity, effort, and gains that are not NaN */
  ISA_ENABLE = 2,          /* is_enabled: 1 enables the device, 0 disables it */
  ISA_GAINS = 4,           /* stiffness and damping alone; NaN keeps the one in force */
  ISA_MODE = 8,            /* mode: the new one */
  ISA_CLEAR_FAULT = 16,    /* ends the state fault, where its cause is gone */
  ISA_QUICK_STOP = 32,
  ISA_REFERENCE = 64       /* reference of a mode of current, spool or pressure */
};

@ENUMERATIONS@

/*
 * The state in which an actuator begins, at rest. With a force its load is not at its position, but
 * where ..._load_position() says: the spring between them, of the force sensor, is loaded.
 */
typedef struct isa_start {
  double position;         /* of piston or rotor, m | rad */
  double force;            /* that it holds with relief valves closed, of its sensor, N | Nm */
  double supply_pressure;  /* Pa gauge */
  double return_pressure;  /* Pa gauge */
} isa_start_t;

/*
 * The load during one tick. Its coordinate x, along the actuator, moves by
 *
 *   x'' = a_bias + jerk t + F inverse_mass - stiffness (x - x_r) - damping (x' - x_r'),
 *   x_r = x0 + v0 t + a0 t^2/2,
 *
 * F being the force of the actuator and t the time since the tick began; x and x' begin at x0 and
 * v0. With inverse_mass = 0 and no a_bias the load moves at v0, whatever the force. An actuator with
 * a load of its own (isa_about.has_own_load) reads the pressures only.
 */
typedef struct isa_port {
  double x0;               /* position of the load, m | rad; at first its load_position() */
  double v0;               /* its speed, m/s | rad/s */
  double a0;               /* acceleration of x_r, m/s2 | rad/s2 */
  double inverse_mass;     /* 1/kg | 1/(kg m2), not negative */
  double a_bias;           /* its acceleration without the actuator's force, m/s2 | rad/s2 */
  double jerk;             /* slope of a_bias, m/s3 | rad/s3 */
  double stiffness;        /* over mass, 1/s2 */
  double damping;          /* over mass, 1/s */
  double supply_pressure;  /* Pa gauge */
  double return_pressure;  /* Pa gauge */
} isa_port_t;

/* A supply whose pressure moves within the tick by what is drawn; zeros: it is held. */
typedef struct isa_feed {
  double elastance;        /* 1/C of the supply, Pa/m3 */
  double inflow;           /* of all else less what all actuators drew last, m3/s */
  double trend;            /* slope of inflow over time, m3/s2 */
  double slope;            /* by how much inflow falls with the pressure, m3/s/Pa */
  double share;            /* dq/dP of all actuators over that of this one */
  double flow;             /* what this one drew last, m3/s */
  double is_warm;          /* 1: its oil has this temperature; 0: that of the configuration */
  double celsius;          /* of the oil that flows in, with is_warm; not below absolute zero */
} isa_feed_t;

/* A command, in force from the begin of the tick that it is given to; zeros: none. */
typedef struct isa_command {
  uint32_t kinds;          /* bits of isa_kind; 0: nothing new */
  uint32_t is_enabled;     /* 0 or 1, with ISA_ENABLE */
  double position;         /* m | rad */
  double velocity;         /* m/s | rad/s */
  double effort;           /* feed-forward, N | Nm */
  double stiffness;        /* of the impedance, N/m | Nm/rad; NaN keeps the one in force */
  double damping;          /* likewise, Ns/m | Nms/rad; NaN keeps the one in force */
  int64_t mode;            /* isa_mode, with ISA_MODE; with ISA_REFERENCE that of the reference */
  double reference;        /* of that mode: amplifier A, m of spool, Pa of difference */
  int64_t due_step;        /* leave it 0; of isa_applied, plant step at which it took effect */
} isa_command_t;

/* What the actuator gives to its load and its supply in a tick. */
typedef struct isa_reply {
  double mean_forces[@WINDOWS@];   /* of its force sensor in each fifth of the tick, N | Nm */
  double force;            /* of the same at the end of the tick */
  double position;         /* of piston or rotor at the end, m | rad */
  double velocity;         /* m/s | rad/s */
  double supply_volume;    /* oil drawn from the supply in this tick, m3 */
  double return_volume;    /* oil given to the return, m3 */
} isa_reply_t;

/*
 * What it drew in the last tick with an isa_feed, for the next one; zeros before the first. A saved
 * state has it too.
 */
typedef struct isa_fed {
  double flow;             /* drawn at the end of the tick, m3/s */
  double conductance;      /* dq/dP of its valve there, m3/s/Pa */
  double paid;             /* energy of the oil drawn in the tick, J */
  double heat;             /* that its oil took along in the tick, with is_warm, J */
} isa_fed_t;

/* The signals at the end of a tick; isa_field has their names and units as text. */
typedef struct isa_sample {
@SAMPLE@
} isa_sample_t;

/* A signal of isa_sample: values[i] of (const double *)sample. */
typedef struct isa_field {
  const char *name;
  const char *unit;
  const char *meaning;
} isa_field_t;

/* A parameter of the exported actuator, as `isa params` lists it; it is fixed. */
typedef struct isa_parameter {
  const char *name;        /* dotted: plant.drive.bore_mm */
  const char *value;       /* as text */
  double number;           /* the value, NaN if it is a word */
  const char *unit;
  const char *range;
  const char *source;
  const char *meaning;
} isa_parameter_t;

typedef struct isa_about {
  const char *name;        /* of the actuator */
  const char *model;
  const char *version;     /* of isa_ros */
  const char *digest;      /* of all its parameters; saved states have it */
  int64_t step_ns;         /* a tick */
  int is_rotary;
  int has_own_load;        /* 1: of a port it reads the pressures only */
  isa_start_t start;       /* at which it is created */
} isa_about_t;

/* A setpoint; the gains in force are kept. */
static inline isa_command_t isa_setpoint(double position, double velocity, double effort)
{
  isa_command_t command = {0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0.0, 0};
  command.kinds = ISA_SETPOINT;
  command.position = position;
  command.velocity = velocity;
  command.effort = effort;
  command.stiffness = command.damping = NAN;
  return command;
}

#elif ISA_ACTUATOR_TYPES != @TYPES@
#error "@NAME@.h and another exported header are of different versions: export both again"
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct @NAME@ @NAME@_t;

const isa_about_t *@NAME@_about(void);

/* Bytes of an instance. */
size_t @NAME@_size(void);

/*
 * Make an instance in memory of the caller, aligned as malloc() aligns, and start it as
 * isa_about.start. There it stays until the caller frees the memory: it cannot be copied or moved,
 * but saved and restored into another. NULL: the memory is NULL, too small or not aligned.
 */
@NAME@_t *@NAME@_create(void *memory, size_t bytes);

/* Put it at rest at t = 0; NULL: as isa_about.start. Nothing of the time before remains. */
int @NAME@_start(@NAME@_t *self, const isa_start_t *start);

/*
 * Advance by one tick.
 *
 * port: NULL: the pressures of the last tick, at first of the start; of an actuator with a load of
 * its own only. feed: NULL: the pressure of the supply is held over the tick. command: NULL: none.
 * What is refused leaves all as it was. A number > 0: 1 + the number of the state that is no longer
 * finite; it is returned again until the next start or restore.
 */
int @NAME@_tick(@NAME@_t *self, const isa_port_t *port, const isa_feed_t *feed,
                const isa_command_t *command);

/*
 * Where the load is at the end of the last tick, by its equation of motion, m | rad: after a start
 * the x0 of the first port, start.position - start.force / sensor stiffness. NaN without instance.
 */
double @NAME@_load_position(const @NAME@_t *self);

/* At the end of the last tick; the memory is that of the instance, the next tick overwrites it. */
const isa_sample_t *@NAME@_sample(const @NAME@_t *self);
const isa_reply_t *@NAME@_reply(const @NAME@_t *self);
const isa_fed_t *@NAME@_fed(const @NAME@_t *self);
/*
 * The command that took effect in the last tick, with all values in force; kinds is 0 without.
 * Before the first tick ISA_SETPOINT | ISA_ENABLE: what it begins with.
 */
const isa_command_t *@NAME@_applied(const @NAME@_t *self);
int64_t @NAME@_time_ns(const @NAME@_t *self);

/* The whole state; ticks after a restore give the same bytes as those after the save. */
size_t @NAME@_state_size(void);
int @NAME@_save(const @NAME@_t *self, void *state, size_t bytes);
int @NAME@_restore(@NAME@_t *self, const void *state, size_t bytes);

/* Signals and parameters by number from 0, NULL beyond; parameters by name, NULL if unknown. */
int @NAME@_field_count(void);
const isa_field_t *@NAME@_field(int index);
int @NAME@_parameter_count(void);
const isa_parameter_t *@NAME@_parameter(int index);
const isa_parameter_t *@NAME@_find(const char *name);

/* What a code means; of one > 0 the state that is not finite. */
const char *@NAME@_message(int code);

#ifdef __cplusplus
}
#endif

#endif
