set(equivalence_definitions
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}"
  ISOSHADE_GOLDENS="${PROJECT_SOURCE_DIR}/tests/golden/hashes.json")

isoshade_test(scenes_test
  SOURCES equivalence/scenes_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 900
  DEVICES)
target_compile_definitions(scenes_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(tiers_test
  SOURCES equivalence/tiers_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 900
  DEVICES)
target_compile_definitions(tiers_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(cartoon_test
  SOURCES equivalence/cartoon_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 300)
target_compile_definitions(cartoon_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(outline_test
  SOURCES equivalence/outline_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 300)
target_compile_definitions(outline_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(posts_test
  SOURCES equivalence/posts_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 300
  DEVICES)
target_compile_definitions(posts_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(textures_test
  SOURCES equivalence/textures_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 300
  DEVICES)
target_compile_definitions(textures_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(samples_test
  SOURCES equivalence/samples_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 300
  DEVICES)
target_compile_definitions(samples_test PRIVATE ${equivalence_definitions} $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

isoshade_test(text_test SOURCES equivalence/text_test.cpp LINKS isoshade_driver LABEL equivalence TIMEOUT 300)
target_compile_definitions(text_test PRIVATE ${equivalence_definitions})

isoshade_test(random_programs_test
  SOURCES equivalence/random_programs_test.cpp conformance/inputs.cpp unit/random_module.cpp
  LINKS isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL equivalence
  TIMEOUT 7200
  DEVICES)
target_compile_definitions(random_programs_test PRIVATE $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)
