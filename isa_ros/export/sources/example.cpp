/*
 * Two instances of @NAME@ in two threads, each with its own memory: a class of C++ around the
 * functions of C.
 *
 *   c++ -std=c++11 -pthread example.cpp -L. -l@NAME@ -Wl,-rpath,'$ORIGIN' -o example && ./example
 */
#include "@NAME@.h"

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

class Actuator {
 public:
  Actuator() : memory_(::operator new(@NAME@_size())),
               self_(@NAME@_create(memory_.get(), @NAME@_size())) {
    if (!self_) throw std::runtime_error("@NAME@: no instance in this memory");
  }

  /* At a supply of constant pressure, which moves what the port says, or its own load. */
  void tick(const isa_port_t &port, const isa_command_t &command) {
    const int code = @NAME@_tick(self_, &port, nullptr, &command);
    if (code) throw std::runtime_error(std::string("@NAME@: ") + @NAME@_message(code));
  }

  double load_position() const { return @NAME@_load_position(self_); }
  const isa_sample_t &sample() const { return *@NAME@_sample(self_); }

  std::vector<unsigned char> save() const {
    std::vector<unsigned char> state(@NAME@_state_size());
    check(@NAME@_save(self_, state.data(), state.size()));
    return state;
  }

  void restore(const std::vector<unsigned char> &state) {
    check(@NAME@_restore(self_, state.data(), state.size()));
  }

 private:
  struct Release { void operator()(void *memory) const { ::operator delete(memory); } };

  static void check(int code) {
    if (code) throw std::runtime_error(@NAME@_message(code));
  }

  std::unique_ptr<void, Release> memory_;
  @NAME@_t *self_;
};

/* Return all samples of half a second against a load that stands still, with a step between. */
static std::vector<isa_sample_t> run(double step) {
  const isa_about_t &about = *@NAME@_about();
  const long ticks = static_cast<long>(500000000 / about.step_ns);
  Actuator actuator;
  std::vector<isa_sample_t> samples(1, actuator.sample());
  isa_port_t port = isa_port_t();
  port.x0 = actuator.load_position();
  port.supply_pressure = about.start.supply_pressure;
  port.return_pressure = about.start.return_pressure;
  for (long k = 0; k < ticks; k++) {
    isa_command_t command = isa_command_t();
    if (k == ticks / 5) command = isa_setpoint(about.start.position + step, 0.0, 0.0);
    if (k == ticks / 2) actuator.restore(actuator.save());
    actuator.tick(port, command);
    samples.push_back(actuator.sample());
  }
  return samples;
}

int main(int argc, char **argv) {
  const double step = @NAME@_about()->is_rotary ? 0.02 : 0.001;
  std::vector<isa_sample_t> one, other;
  std::thread thread([&] { other = run(-step); });
  one = run(step);
  thread.join();
  std::printf("%zu samples each, forces at the end %.2f and %.2f\n", one.size(), one.back().force,
              other.back().force);
  if (argc < 2) return 0;
  std::FILE *file = std::fopen(argv[1], "wb");
  if (!file) return 1;
  std::fwrite(one.data(), sizeof one[0], one.size(), file);
  std::fwrite(other.data(), sizeof other[0], other.size(), file);
  return std::fclose(file);
}
