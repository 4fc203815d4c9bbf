isoshade_test(raster_test
  SOURCES
    unit/raster_bins_test.cpp
    unit/raster_clip_lanes_test.cpp
    unit/raster_clip_test.cpp
    unit/raster_tile_test.cpp
  LINKS isoshade_raster)

isoshade_test(backend_test SOURCES unit/backend_array_limit_test.cpp LINKS isoshade_backend)

isoshade_test(cpu_test
  SOURCES
    unit/cpu_backend_test.cpp
    unit/cpu_builds_test.cpp
    unit/cpu_cache_test.cpp
    unit/cpu_compiler_test.cpp
    unit/cpu_kernel_test.cpp
  LINKS isoshade_cpu)
target_compile_definitions(cpu_test PRIVATE ISOSHADE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

isoshade_test(interpreter_test
  SOURCES
    unit/interpreter_backend_test.cpp
    unit/interpreter_code_test.cpp
  LINKS isoshade_cpu isoshade_interpreter)

isoshade_test(reference_test
  SOURCES
    unit/reference_backend_test.cpp
    unit/reference_functions_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter isoshade_reference
  TIMEOUT 300)
target_compile_definitions(reference_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
