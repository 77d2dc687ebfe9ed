// Programs that this one starts, installed beside its modules.
#pragma once

#include <string>

namespace impactdic {

// The path of program `name` in the first folder that has it, of those where the dynamic linker
// looks for the modules of whoever holds this function; "" where none has it.
std::string helper_program(const std::string& name);

// A file descriptor, closed with the object. -1: none.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void set(int number);
  void close();

 private:
  int number_;
};

}  // namespace impactdic
