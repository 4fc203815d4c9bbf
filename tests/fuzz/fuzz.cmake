add_library(fuzz_feed STATIC fuzz/feed.cpp)
target_link_libraries(fuzz_feed PUBLIC isoshade_driver isoshade_scene)
target_compile_definitions(fuzz_feed PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(documents_test SOURCES fuzz/documents_test.cpp LINKS fuzz_feed TIMEOUT 5400)
target_compile_definitions(documents_test PRIVATE
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_DIAGNOSTICS="${PROJECT_SOURCE_DIR}/tests/diagnostics")

set(fuzz_readers png jpeg hdr exr netpbm gltf)
list(TRANSFORM fuzz_readers REPLACE "(.+)" "fuzz/\\1_reader.cpp" OUTPUT_VARIABLE fuzz_reader_sources)
add_library(fuzz_readers STATIC fuzz/read_image.cpp ${fuzz_reader_sources})
target_link_libraries(fuzz_readers PUBLIC isoshade_scene OpenEXR::OpenEXR PkgConfig::jpeg)
target_compile_definitions(fuzz_readers PRIVATE ISOSHADE_CORPUS="${PROJECT_SOURCE_DIR}/tests/fuzz/corpus")
isoshade_test(images_fuzz_test SOURCES fuzz/images_test.cpp LINKS fuzz_readers TIMEOUT 5400)

if(ISOSHADE_FUZZ)
  add_executable(fuzz_documents fuzz/fuzz_target.cpp)
  target_link_libraries(fuzz_documents PRIVATE fuzz_feed)
  target_link_options(fuzz_documents PRIVATE -fsanitize=fuzzer)
  foreach(reader ${fuzz_readers})
    add_executable(fuzz_${reader} fuzz/reader_target.cpp)
    target_link_libraries(fuzz_${reader} PRIVATE fuzz_readers)
    target_link_options(fuzz_${reader} PRIVATE -fsanitize=fuzzer)
    target_compile_definitions(fuzz_${reader} PRIVATE FUZZ_READER=${reader}_reader)
  endforeach()
endif()
