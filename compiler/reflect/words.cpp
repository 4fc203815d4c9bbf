// SPDX-License-Identifier: Apache-2.0
// The words of a reflection, from the tables that declare them.
#include "compiler/driver/program.h"
#include "compiler/interface/host.h"
#include "compiler/interface/skips.h"
#include "compiler/nodes/table.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/assert.h"

namespace isoshade::reflect::words {

namespace {

std::vector<std::string_view> choices_of_image(size_t port) {
  const nodes::Row* image = nodes::find("image");
  support::assert_that(image != nullptr, "there is no node image");
  return image->ports[port].choices;
}

}  // namespace

std::vector<std::string_view> kinds() {
  using enum graph::DocumentKind;
  return {graph::kind_name(function), graph::kind_name(effect), graph::kind_name(post)};
}

std::vector<std::string_view> types() { return graph::all_type_names(); }

std::vector<std::string_view> ir_types() {
  return {ir::name(ir::bool_type),      ir::name(ir::int_type),       ir::name(ir::float_type),
          ir::name(ir::vector_type(2)), ir::name(ir::vector_type(3)), ir::name(ir::vector_type(4))};
}

std::vector<std::string_view> tiers() {
  std::vector<std::string_view> names;
  for (const functions::Tier tier : functions::tiers) names.push_back(functions::tier_name(tier));
  return names;
}

std::vector<std::string_view> divisions() {
  return {driver::division_names.begin(), driver::division_names.end()};
}

std::vector<std::string_view> attributes() {
  std::vector<std::string_view> names;
  for (size_t i = 0; i < interface::surface_count; ++i)
    names.push_back(interface::row(static_cast<interface::Surface>(i)).name);
  return names;
}

std::vector<std::string_view> spaces() {
  return {nodes::space_names.begin(), nodes::space_names.begin() + interface::space_count};
}

std::vector<std::string_view> filters() { return choices_of_image(nodes::image_port::filtertype); }
std::vector<std::string_view> wraps() { return choices_of_image(nodes::image_port::uaddressmode); }

std::vector<std::string_view> host_functions() {
  std::vector<std::string_view> names;
  for (size_t i = 0; i < interface::host_call_count; ++i)
    names.push_back(interface::row(static_cast<interface::HostCall>(i)).name);
  return names;
}

std::vector<std::string_view> vertex_fields() {
  return {
#define VERTEX(name, words) #name,
#include "compiler/interface/records.def"
  };
}

std::vector<std::string_view> skips() {
  std::vector<std::string_view> names;
  for (const interface::SkipRow& row : interface::skip_rows) names.push_back(row.name);
  return names;
}

std::vector<std::string_view> stages() {
  using enum lower::Stage;
  return {lower::name(vertex), lower::name(cutout), lower::name(pixel), lower::name(blend),
          lower::name(eval), lower::name(post)};
}

}  // namespace isoshade::reflect::words
