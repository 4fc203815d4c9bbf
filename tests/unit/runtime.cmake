isoshade_test(scene_test
  SOURCES
    unit/scene_animate_test.cpp
    unit/scene_animation_file_test.cpp
    unit/scene_deflate_test.cpp
    unit/scene_environment_test.cpp
    unit/scene_exr_test.cpp
    unit/scene_format_test.cpp
    unit/scene_gltf_test.cpp
    unit/scene_gltf_textures_test.cpp
    unit/scene_hdr_test.cpp
    unit/scene_image_file_test.cpp
    unit/scene_image_formats_test.cpp
    unit/scene_jpeg_test.cpp
    unit/scene_load_test.cpp
    unit/scene_mesh_test.cpp
    unit/scene_netpbm_test.cpp
    unit/scene_output_file_test.cpp
    unit/scene_parse_test.cpp
    unit/scene_png_test.cpp
    unit/scene_placement_test.cpp
    unit/scene_settings_test.cpp
    unit/scene_texture_test.cpp
  LINKS isoshade_scene isoshade_raster OpenEXR::OpenEXR PkgConfig::jpeg GIF::GIF ZLIB::ZLIB)
target_compile_definitions(scene_test PRIVATE ISOSHADE_CORPUS="${PROJECT_SOURCE_DIR}/tests/fuzz/corpus")

isoshade_test(compare_test
  SOURCES
    unit/compare_golden_test.cpp
    unit/compare_report_test.cpp
    unit/compare_test.cpp
  LINKS isoshade_compare)

isoshade_test(environment_test
  SOURCES unit/environment_maps_test.cpp
  LINKS isoshade_environment)
target_compile_definitions(environment_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(render_test
  SOURCES
    unit/render_finite_test.cpp
    unit/render_images_test.cpp
    unit/render_parts_test.cpp
    unit/render_plan_test.cpp
    unit/render_posts_test.cpp
    unit/render_repeat_test.cpp
    unit/render_samples_test.cpp
    unit/render_textures_test.cpp
    unit/render_visibility_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter PkgConfig::jpeg)
target_compile_definitions(render_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(frame_planner_test
  SOURCES unit/render_frame_planner_test.cpp
  LINKS isoshade_render)
target_compile_definitions(frame_planner_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(page_test
  SOURCES unit/page_test.cpp
  LINKS isoshade_page isoshade_interpreter nlohmann_json::nlohmann_json)
