set(equivalence_definitions
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}"
  ISOSHADE_GOLDENS="${PROJECT_SOURCE_DIR}/tests/golden/hashes.json")

# A test of the file of its name, on every backend.
function(equivalence_test name timeout)
  isoshade_test(${name}
    SOURCES equivalence/${name}.cpp
    LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
    LABEL equivalence
    TIMEOUT ${timeout}
    DEVICES)
  target_compile_definitions(${name} PRIVATE
    ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)
endfunction()

equivalence_test(scenes_test 900)
equivalence_test(branches_test 300)
equivalence_test(tiers_test 900)
equivalence_test(posts_test 300)
equivalence_test(textures_test 300)
equivalence_test(images_test 300)
equivalence_test(calls_test 300)
equivalence_test(samples_test 600)
equivalence_test(cutouts_test 300)
equivalence_test(repeats_test 300)
equivalence_test(shadows_test 300)
equivalence_test(unseen_shadows_test 300)
equivalence_test(environment_scenes_test 300)
equivalence_test(blending_test 300)
equivalence_test(motion_test 600)
equivalence_test(parameters_test 600)
equivalence_test(views_test 300)
equivalence_test(skips_test 300)
equivalence_test(tiles_test 300)
equivalence_test(random_scenes_test 7200)
equivalence_test(pure_test 900)
target_sources(pure_test PRIVATE equivalence/pure_host.cpp equivalence/pure_subject.cpp)

isoshade_test(forward_test SOURCES equivalence/forward_test.cpp LINKS isoshade_driver LABEL equivalence TIMEOUT 300)
target_compile_definitions(forward_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
isoshade_test(text_test SOURCES equivalence/text_test.cpp LINKS isoshade_driver LABEL equivalence TIMEOUT 300)
target_compile_definitions(text_test PRIVATE ${equivalence_definitions})

isoshade_test(random_programs_test
  SOURCES equivalence/random_programs_test.cpp conformance/inputs.cpp unit/random_module.cpp
  LINKS isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 7200
  DEVICES)
target_compile_definitions(random_programs_test PRIVATE $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)
