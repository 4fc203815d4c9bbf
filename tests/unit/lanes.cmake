# One object of all functions of runtime/lanes for each lane count and instruction set. Optimised in every build type,
# as generated code is.
set(avx512 -mavx512f -mavx512vl -mavx512dq -mavx512bw)
set(lanes_objects)
function(isoshade_lanes_kernels table float)
  add_library(lanes_kernels_${table} OBJECT unit/lanes_kernels.cpp)
  target_link_libraries(lanes_kernels_${table} PRIVATE isoshade_lanes)
  target_compile_definitions(lanes_kernels_${table} PRIVATE LANES_TABLE=kernels_${table} "LANES_FLOAT=${float}")
  target_compile_options(lanes_kernels_${table} PRIVATE -O2 ${ARGN})
  set(lanes_objects ${lanes_objects} lanes_kernels_${table} PARENT_SCOPE)
endfunction()

isoshade_lanes_kernels(scalar_sse2 "float")
isoshade_lanes_kernels(scalar_sse4 "float" -msse4.1)
isoshade_lanes_kernels(4x1_sse2 "Float<4, 1>")
isoshade_lanes_kernels(4x1_sse4 "Float<4, 1>" -msse4.1)
isoshade_lanes_kernels(4x1_avx2 "Float<4, 1>" -mavx2)
isoshade_lanes_kernels(8x1_avx2 "Float<8, 1>" -mavx2)
isoshade_lanes_kernels(8x2_avx2 "Float<8, 2>" -mavx2)
isoshade_lanes_kernels(8x2_avx512 "Float<8, 2>" ${avx512})
isoshade_lanes_kernels(16x1_avx512 "Float<16, 1>" ${avx512})
isoshade_lanes_kernels(16x2_avx512 "Float<16, 2>" ${avx512})

isoshade_test(lanes_test SOURCES unit/lanes_test.cpp LINKS isoshade_lanes ${lanes_objects})
