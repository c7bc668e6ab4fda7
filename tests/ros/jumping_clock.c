/*
 * The system's clock with a jump that a test chooses: LD_PRELOAD this into a process.
 *
 * ISA_ROS_CLOCK_SHIFT names a file of eight bytes, the shift of CLOCK_REALTIME in seconds. It is
 * mapped, so that all processes of a run jump at the moment it is written. The kernel keeps its
 * own time. So a thread that waits for an instant of CLOCK_REALTIME, as the middleware's do, is
 * late by a positive shift, as after the real clock was set back, and wakes at once under a
 * negative one, as after it was set forth; but at every wait, where a real jump meets one.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static int64_t shift(void)
{
  static const volatile int64_t * shared;
  if (!shared) {
    const char * path = getenv("ISA_ROS_CLOCK_SHIFT");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0) {
      return 0;
    }
    void * mapped = mmap(NULL, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    if (mapped == MAP_FAILED) {
      return 0;
    }
    shared = mapped;
  }
  return *shared;
}

int clock_gettime(clockid_t id, struct timespec * now)
{
  static int (* real)(clockid_t, struct timespec *);
  if (!real) {
    real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
  }
  int result = real(id, now);
  if (result == 0 && (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE)) {
    now->tv_sec += shift();
  }
  return result;
}

int gettimeofday(struct timeval * now, void * zone)
{
  struct timespec t;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &t);
  now->tv_sec = t.tv_sec;
  now->tv_usec = t.tv_nsec / 1000;
  return 0;
}

time_t time(time_t * now)
{
  struct timespec t;
  clock_gettime(CLOCK_REALTIME, &t);
  if (now) {
    *now = t.tv_sec;
  }
  return t.tv_sec;
}
