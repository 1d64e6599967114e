// Checks that this compiler, with the project's options, keeps a store that a called function makes through a pointer.
// g++ 12.1 to 12.4, 13.1 to 13.3 and 14.1 do not (GCC bug 114207): -fipa-modref takes the store for one to the first
// element, so that the model of a device saw no force. CMakeLists.txt gives every g++ below 14.2 -fno-ipa-modref.
// Exits with 1 where the compiler has the bug and the option is lost.
#include <array>
#include <cstddef>
#include <cstdio>

namespace {

struct Vector {
  std::array<double, 3> elements{};
  double* begin() { return elements.data(); }
};

// Fills a vector element by element, as Eigen's comma initialiser does.
struct Writer {
  Vector* vector;
  std::ptrdiff_t position;
  void write(double value) { vector->begin()[position] = value; }
};

[[gnu::noinline]] void write_last(Vector& vector, double value) {
  Writer writer{&vector, 2};
  writer.write(value);
}

[[gnu::noinline]] double first_of(const Vector& vector) {
  return vector.elements[0];
}

// Wrong code reads the 0 from before the call.
bool sees_store_of_the_call() {
  Vector vector;
  write_last(vector, 1);
  return vector.elements[2] == 1;
}

// Wrong code leaves out the 7, which the call seems to overwrite.
bool keeps_store_before_the_call() {
  Vector vector;
  vector.elements[0] = 7;
  write_last(vector, 1);
  return first_of(vector) == 7;
}

}  // namespace

int main() {
  if (sees_store_of_the_call() && keeps_store_before_the_call()) return 0;
  std::puts("This compiler gives wrong code (GCC bug 114207). Compile with -fno-ipa-modref.");
  return 1;
}
