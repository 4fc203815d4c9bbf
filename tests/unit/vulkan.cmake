isoshade_test(emit_spirv_test
  SOURCES
    unit/emit_glsl_es_test.cpp
    unit/emit_names_of_groups_test.cpp
    unit/emit_names_test.cpp
    unit/emit_nesting_test.cpp
    unit/emit_spirv_test.cpp
    unit/random_module.cpp
  LINKS isoshade_passes isoshade_targets)

if(ISOSHADE_VULKAN)
  isoshade_test(vulkan_test
    SOURCES
      unit/vulkan_backend_test.cpp
      unit/vulkan_cache_test.cpp
      unit/vulkan_device_test.cpp
      unit/vulkan_probe_test.cpp
      unit/vulkan_setup_test.cpp
    LINKS isoshade_vulkan
    TIMEOUT 120
    DEVICES)

  isoshade_test(bench_test SOURCES unit/bench_scenes_test.cpp LINKS isoshade_bench DEVICES)
  target_compile_definitions(bench_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
endif()
