add_library(fuzz_feed STATIC fuzz/feed.cpp)
target_link_libraries(fuzz_feed PUBLIC isoshade_driver isoshade_scene)
target_compile_definitions(fuzz_feed PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(documents_test SOURCES fuzz/documents_test.cpp LINKS fuzz_feed TIMEOUT 5400)
target_compile_definitions(documents_test PRIVATE
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_DIAGNOSTICS="${PROJECT_SOURCE_DIR}/tests/diagnostics")

if(ISOSHADE_FUZZ)
  add_executable(fuzz_documents fuzz/fuzz_target.cpp)
  target_link_libraries(fuzz_documents PRIVATE fuzz_feed)
  target_link_options(fuzz_documents PRIVATE -fsanitize=fuzzer)
endif()

isoshade_test(gltf_fuzz_test SOURCES fuzz/gltf_test.cpp LINKS isoshade_scene TIMEOUT 600)
isoshade_test(images_fuzz_test SOURCES fuzz/images_test.cpp LINKS isoshade_scene PkgConfig::stb TIMEOUT 600)
