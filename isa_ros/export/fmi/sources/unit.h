/*
 * An actuator with its supply as a unit of co-simulation: what both versions of FMI share.
 *
 * A unit is one instance; different ones may be used by different threads at the same time. Time
 * is whole ticks. Numbers of every type are doubles here.
 */
#ifndef ISA_UNIT_H
#define ISA_UNIT_H

#include "types.h"

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* As both versions number them. */
enum status { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR };

typedef struct unit unit_t;

#define UNIT_MESSAGE_BYTES 400   /* of the longest message, with its end */

struct importer;

/* Hands a message to the importer; category is one of the model description. */
typedef void report_t(const struct importer *to, enum status status, const char *category,
                      const char *message);

/* What the version of FMI needs for its messages. */
struct importer {
  const char *name;            /* of the instance; copied */
  void *environment;
  void (*logger)(void);        /* called by report with its own type */
  report_t *report;
};

/* Say that an instance is not made for what it was to do; return NULL. */
unit_t *unit_refuse_creation(const struct importer *importer, const char *what);

/* Make an instance that has not begun; NULL: the token is that of another unit, or no memory. */
unit_t *unit_create(const struct importer *importer, const char *token);
void unit_free(unit_t *unit);

/* Put all back to where it was after unit_create. */
enum status unit_reset(unit_t *unit);

/* The time at which it begins, s; before unit_begin. */
enum status unit_set_begin(unit_t *unit, double time);

/* Put the actuator at rest; parameters may still be set, which starts it again. */
enum status unit_begin(unit_t *unit);
enum status unit_end_begin(unit_t *unit);
enum status unit_terminate(unit_t *unit);

/* Values of one type by their references; what a write refuses stays as it was. */
enum status unit_read(const unit_t *unit, enum type type, const uint32_t *references, size_t n,
                      double *values);
enum status unit_read_whole(const unit_t *unit, enum type type, uint32_t reference, int64_t *value);
enum status unit_read_text(const unit_t *unit, uint32_t reference, const char **text);
enum status unit_write(unit_t *unit, enum type type, const uint32_t *references, size_t n,
                       const double *values);

/* Return whether a reference is that of an enumeration, for versions that have no such type. */
int unit_is_enumeration(uint32_t reference);

/* Advance from a time by a size, s, a multiple of the tick; else nothing is done, STATUS_ERROR. */
enum status unit_step(unit_t *unit, double from, double size);
double unit_time(const unit_t *unit);

/*
 * The whole state, in memory of its own that free() frees; *state is NULL or one of before. As
 * bytes it can go to another instance of the same unit.
 */
enum status unit_get_state(const unit_t *unit, void **state);
enum status unit_set_state(unit_t *unit, const void *state);
size_t unit_state_size(void);
enum status unit_serialize(const unit_t *unit, const void *state, void *bytes, size_t size);
enum status unit_deserialize(const unit_t *unit, const void *bytes, size_t size, void **state);

/* Refuse a call that this unit does not have: "what is not possible with this unit". */
enum status unit_refuse(const unit_t *unit, const char *what);

#endif
