# Compiles generated C++ and the headers of runtime/lanes as standard C++, here and for AArch64, and runs it.
isoshade_test(portable_test
  SOURCES portable/portable_test.cpp conformance/cases.cpp conformance/inputs.cpp
  LINKS isoshade_interpreter isoshade_lanes lanes_kernels_scalar_sse2
  LABEL conformance
  TIMEOUT 600)
target_compile_definitions(portable_test PRIVATE ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}")
