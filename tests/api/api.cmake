# The libraries as programs see them. isoshade_api is linked too, for the boundary alone.
isoshade_test(api_test
  SOURCES
    api/boundary_test.cpp
    api/compiler_test.cpp
    api/memory_test.cpp
    api/runtime_test.cpp
  LINKS isoshade_api isoshade::compiler isoshade::runtime TBB::tbb
  TIMEOUT 120
  DEVICES)
target_compile_definitions(api_test PRIVATE
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs" $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)
