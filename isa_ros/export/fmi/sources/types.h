/* The types of the tables that `isa export` makes for a unit. */
#ifndef ISA_TYPES_H
#define ISA_TYPES_H

#include <stddef.h>
#include <stdint.h>

enum type { TYPE_REAL, TYPE_INTEGER, TYPE_BOOLEAN, TYPE_ENUMERATION, TYPE_TEXT };

/* Where a value is; its place counts from there. */
enum home {
  HOME_TIME,
  HOME_INPUT,                /* what may be set */
  HOME_SAMPLE,               /* of the actuator */
  HOME_REPLY,
  HOME_SUPPLY,               /* its sample */
  HOME_NUMBER,               /* constants */
  HOME_TEXT
};

struct variable {
  const char *name, *unit;   /* for messages */
  double low, high;          /* the range of what may be set */
  int32_t place;
  unsigned char type, home;
};

/* A number of a table of a kernel: a place in the memory, or the length of an axis. */
struct word {
  int64_t value;
  int is_place;
};

/* A kernel, and where its table begins among the words. */
struct call {
  int64_t (*run)(const int64_t *table);
  int32_t table;
};

/* A parameter that may change: its input, and its place in the memory of the actuator. */
struct tuned {
  int32_t input, place;
};

#endif
