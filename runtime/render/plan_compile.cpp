// SPDX-License-Identifier: Apache-2.0
// What a planner compiles: the effects of all objects and the posts, for the values that the scene fixes.
#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include "compiler/ir/printer.h"
#include "compiler/ir/record_words.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/lanes.h"
#include "runtime/render/light_reach.h"
#include "runtime/render/planner.h"

namespace isoshade::render {

using scene::Object;
using support::Diagnostics;
using support::quote;

namespace {

lower::LightKinds kinds_of(const std::vector<scene::Light>& lights) {
  lower::LightKinds kinds{false, false, false, {}};
  for (const scene::Light& light : lights) {
    kinds.directional |= light.kind == scene::LightKind::directional;
    kinds.point |= light.kind == scene::LightKind::point;
    kinds.spot |= light.kind == scene::LightKind::spot;
    kinds.shadows |= light.shadow.has_value();
    kinds.lists |= may_be_left_out(light);
  }
  return kinds;
}

bool draw_reads_frame(const driver::Program& program) {
  return program.draw != nullptr &&
         ir::loads_from(program.draw->module, static_cast<uint32_t>(lower::FrameBuffer::frame));
}

}  // namespace

std::string Compiled::key_of(const check::TypedGraph& typed, const driver::CompileOptions& options) {
  const lower::LightKinds& lights = options.lights;
  std::string key;
  for (const bool bit : {options.reference, lights.directional, lights.point, lights.spot, lights.shadows,
                         lights.lists, lights.environment.has_value(), lights.environment.value_or(false)})
    key += bit ? '1' : '0';
  key += std::to_string(static_cast<int>(options.tier));
  for (const std::optional<float>& word : options.fixed)
    key += word ? " " + std::to_string(std::bit_cast<uint32_t>(*word)) : " -";
  // The library has one graph for each function document as long as somebody has it.
  for (const auto& node : typed.nodes)
    if (node.callee != nullptr) key += " " + std::to_string(reinterpret_cast<uintptr_t>(node.callee.get()));
  const auto add = [&](const support::Source& source) { key.append("\n").append(source->path()).append("\n").append(source->text()); };
  add(typed.graph.source);
  std::ranges::for_each(typed.graph.bases, add);
  return key;
}

driver::CompileOptions Planner::compile_options() const {
  driver::CompileOptions options = options_.compiler;
  options.lights = kinds_of(scene_->lights);
  options.lights.lists &= skips(interface::Skip::lights);
  options.lights.environment = scene_->environment.has_value();
  return options;
}

bool Planner::check_effects() {
  driver::CompileOptions options = compile_options();
  const bool shadows = options.lights.shadows;
  std::map<std::pair<std::string, bool>, size_t> known;
  bool good = true;
  for (const Object& object : scene_->objects) {
    const bool in_shadow = shadows && object.receives_shadow;
    const auto [found, is_new] = known.try_emplace({object.effect, in_shadow}, plan_.effects.size());
    effect_of_object_.push_back(found->second);
    if (!is_new) continue;
    const bool is_reported = !good && known.contains({object.effect, !in_shadow});
    const support::Source source = is_reported ? nullptr : read_document(object.effect, object.effect_where);
    auto effect = source != nullptr ? driver::check_effect(source, options, *diagnostics_) : std::nullopt;
    if (!effect && !is_reported && !diagnostics_->full() && !diagnostics_->all().empty()) {
      diagnostics_->all().back().note(object.effect_where, "the effect of " + quote(object.name));
    }
    good = good && effect.has_value();
    plan_.effects.push_back(effect ? *std::move(effect) : driver::Effect{});
  }
  return good;
}

void Planner::compile_effects() {
  driver::CompileOptions options = compile_options();
  const bool shadows = options.lights.shadows;
  std::vector<std::vector<size_t>> objects(plan_.effects.size());  // by effect
  for (size_t o = 0; o < scene_->objects.size(); ++o) objects[effect_of_object_[o]].push_back(o);
  std::vector<driver::Effect> checked = std::exchange(plan_.effects, {});
  const lanes::FpGuard guard;
  for (size_t e = 0; e < checked.size(); ++e) {
    std::vector<driver::FixedWords> given;
    for (const size_t o : objects[e]) given.push_back(given_by_object(o, checked[e].parameters));
    options.lights.shadows = shadows && scene_->objects[objects[e].front()].receives_shadow;
    const auto make = [&](driver::FixedWords fixed) {
      driver::Effect made = checked[e];
      options.fixed = std::move(fixed);
      compiled_.make(made, options);
      return made;
    };
    for (auto& variant : variants_of<driver::Effect>(checked[e].parameters, given, make)) {
      for (const size_t member : variant.members) effect_of_object_[objects[e][member]] = plan_.effects.size();
      plan_.effects.push_back(std::move(variant.document));
    }
  }
  // Only now, because the effects no longer move.
  for (const driver::Effect& effect : plan_.effects) {
    std::vector<PassPrograms>& programs = programs_of_effect_.emplace_back();
    for (const driver::EffectPass& pass : effect.passes) {
      const uint32_t vertex = add_program(pass.vertex);
      const uint32_t cutout = pass.cutout ? add_program(*pass.cutout) : backends::Frame::no_program;
      const uint32_t pixel = add_program(pass.pixel, cutout);
      programs.push_back({vertex, pixel, pass.blend ? add_program(*pass.blend, cutout) : pixel});
      driver::for_each_program(pass, [&](const driver::Program& program) {
        draws_read_frame_ = draws_read_frame_ || draw_reads_frame(program);
      });
    }
  }
}

bool Planner::compile_posts() {
  driver::CompileOptions options = compile_options();
  std::map<std::string, size_t> known;
  std::vector<driver::Post> checked;
  std::vector<std::vector<size_t>> posts;  // by document
  bool good = true;
  for (size_t p = 0; p < scene_->posts.size(); ++p) {
    const scene::Post& post = scene_->posts[p];
    const auto [found, is_new] = known.try_emplace(post.effect, checked.size());
    if (is_new) {
      posts.emplace_back();
      const support::Source source = read_document(post.effect, post.effect_where);
      auto document = source != nullptr ? driver::check_post(source, options, *diagnostics_) : std::nullopt;
      if (!document && !diagnostics_->full() && !diagnostics_->all().empty())
        diagnostics_->all().back().note(post.effect_where, "the effect of post " + quote(post.name));
      good = good && document.has_value();
      checked.push_back(document ? *std::move(document) : driver::Post{});
    }
    posts[found->second].push_back(p);
  }
  if (!good) return false;
  std::vector<size_t> document_of_post(scene_->posts.size());
  const lanes::FpGuard guard;
  for (size_t d = 0; d < checked.size(); ++d) {
    std::vector<driver::FixedWords> given;
    for (const size_t p : posts[d]) given.push_back(given_by_post(p, checked[d].parameters));
    const auto make = [&](driver::FixedWords fixed) {
      driver::Post made = checked[d];
      options.fixed = std::move(fixed);
      compiled_.make(made, options);
      return made;
    };
    for (auto& variant : variants_of<driver::Post>(checked[d].parameters, given, make)) {
      for (const size_t member : variant.members) document_of_post[posts[d][member]] = plan_.post_documents.size();
      plan_.post_documents.push_back(std::move(variant.document));
    }
  }
  // Only now, because the documents no longer move.
  for (const size_t document : document_of_post) posts_.push_back(&plan_.post_documents[document]);
  return true;
}

/// Equal programs share an index: most effects have the same vertex program.
uint32_t Planner::add_program(const driver::Program& program, uint32_t cutout) {
  std::string text = std::to_string(static_cast<int>(program.stage)) + "\n" + std::to_string(cutout) + "\n" +
                     std::to_string(program.entry) + "\n" + ir::print(program.module);
  const auto next = static_cast<uint32_t>(plan_.frame.programs.size());
  const auto [found, is_new] = program_by_text_.try_emplace(std::move(text), next);
  std::vector<uint32_t>& cutouts = plan_.frame.cutouts;
  if (is_new) plan_.frame.programs.push_back(&program);
  if (is_new && (cutout != backends::Frame::no_program || !cutouts.empty())) {
    cutouts.resize(plan_.frame.programs.size(), backends::Frame::no_program);
    cutouts.back() = cutout;
  }
  return found->second;
}

bool Planner::fixes_parameters() const {
  return skips(interface::Skip::parameters) && !options_.disabled && !options_.compiler.reference;
}

driver::FixedWords Planner::given_by(std::string_view owner, const driver::ParameterBlock& block,
                                     driver::FixedWords words) const {
  const auto release = [&](size_t first, int count) {
    for (int i = 0; i < count; ++i) words[first + static_cast<size_t>(i)].reset();
  };
  const auto changes = [&](const std::string& parameter) {
    const auto is_animated = [&](const scene::AnimatedParameter& animated) {
      return animated.owner == owner && animated.parameter == parameter;
    };
    return options_.changing.contains(parameter) || std::ranges::any_of(scene_->animated, is_animated);
  };
  for (size_t i = 0; i < block.fields.size() && !words.empty(); ++i)
    if (block.fields[i].dynamic || changes(block.fields[i].name)) release(block.word_of(i), block.fields[i].words);
  for (size_t i = 0; i < block.images.size() && !words.empty(); ++i) {
    const lower::ImageSlot& slot = block.images[i].slot;
    const auto field = block.find(slot.parameter);
    if (changes(slot.name) || (field && (block.fields[*field].dynamic || changes(slot.parameter))))
      release(block.word_of_image(i), 1);
  }
  return words;
}

driver::FixedWords Planner::given_by_object(size_t o, const driver::ParameterBlock& block) const {
  driver::FixedWords words;
  if (!fixes_parameters()) return words;
  bool is_first = true;
  for (const PartValues* values : {&parameters_[o], &parameters_before_[o]})
    for (const ParameterValues& part : *values) {
      if (std::exchange(is_first, false))
        words = part.common();
      else
        keep_common(words, part.common());
    }
  return given_by(scene_->objects[o].name, block, std::move(words));
}

driver::FixedWords Planner::given_by_post(size_t p, const driver::ParameterBlock& block) const {
  if (!fixes_parameters()) return {};
  const scene::Post& post = scene_->posts[p];
  Diagnostics unheard;  // plan_posts() reports them
  const auto values = ParameterValues::resolve(block, {post.name, post.parameters}, {}, unheard);
  return values ? given_by(post.name, block, values->common()) : driver::FixedWords();
}

bool Planner::keeps_fixed(const driver::ParameterBlock& block, const driver::FixedWords& fixed,
                          const driver::FixedWords& given) {
  for (std::string& name : broken_by(block, fixed, given)) changed_.insert(std::move(name));
  return changed_.empty();
}

bool Planner::posts_keep_fixed() {
  const lanes::FpGuard guard;
  for (size_t p = 0; p < posts_.size(); ++p)
    if (!keeps_fixed(posts_[p]->parameters, posts_[p]->fixed, given_by_post(p, posts_[p]->parameters))) return false;
  return true;
}

void Planner::report_programs() {
  const auto add = [&](const std::vector<Skipped>& skips) {
    skipped_in_programs_.insert(skipped_in_programs_.end(), skips.begin(), skips.end());
  };
  for (const driver::Effect& effect : plan_.effects) add(driver::skipped_in(effect));
  for (const driver::Post& post : plan_.post_documents) add(driver::skipped_in(post));
}

}  // namespace isoshade::render
