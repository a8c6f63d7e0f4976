// What the sanitizers ask the program for when it starts; linked into the tests of sanitizer builds only.
extern "C" {

// HDF5 1.10 loses memory where it gives up on damaged metadata; the tests damage it on purpose.
const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }
const char* __lsan_default_options();
const char* __lsan_default_options() { return "print_suppressions=0"; }

// Of libraries that are not compiled for it ThreadSanitizer sees only some accesses and not by what their
// threads wait for each other: what libzmq does to its own memory. What they wait by still counts, and so
// does our code that they call.
const char* __tsan_default_options();
const char* __tsan_default_options() {
  return "halt_on_error=1:second_deadlock_stack=1:ignore_noninstrumented_modules=1";
}

}  // extern "C"
