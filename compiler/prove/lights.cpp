// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/lights.h"

#include <algorithm>
#include <variant>
#include <vector>

#include "compiler/prove/document.h"
#include "compiler/prove/evaluate.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::prove {
namespace {

namespace source = interface::source;

/// More directions than this are not looked at: each of them may also be 0, and all combinations are proved.
constexpr size_t most_directions = 5;
constexpr size_t most_operations = 500'000;  ///< of all these proofs
/// Small, because a scene waits for it; shipped effects take far less.
constexpr Effort effort{.proof = 1'000'000, .later = 0, .error = 0, .samples = 0, .tries = 0};

/// Whether an input of a document is as assumed in every scene whose values are ordinary (BlackLights).
bool is_ordinary(const interface::Binding& binding) {
  return std::visit(interface::Cases{
                        [](const source::Attribute& s) {
                          switch (s.value.attribute) {
                            case interface::Surface::position:
                            case interface::Surface::normal:
                            case interface::Surface::texcoord:
                            case interface::Surface::texcoord1:
                            case interface::Surface::view_direction:
                            case interface::Surface::tangent:
                            case interface::Surface::bitangent:
                            case interface::Surface::color:
                            case interface::Surface::outline_normal:
                            case interface::Surface::front_facing: return true;
                            case interface::Surface::shown_position:
                            case interface::Surface::previous_position:
                            case interface::Surface::pixel_size:
                            case interface::Surface::corner_normal1:
                            case interface::Surface::corner_normal2:
                            case interface::Surface::corner_normal3: return false;
                          }
                          return false;
                        },
                        [](const source::PassRepetition&) { return true; },
                        [](const source::Input&) { return true; },
                        [](const source::Image&) { return true; },
                        [](const source::LightCount&) { return true; },
                        [](const source::HasEnvironment&) { return true; },
                        [](const auto&) { return false; },
                    },
                    binding.source);
}

/// What is asked of a host is as assumed: of its lights because they are black, of textures because texels are
/// ordinary.
bool is_ordinary(interface::Host host) {
  switch (host) {
    case interface::Host::light:
    case interface::Host::texel:
    case interface::Host::texture_layer:
    case interface::Host::texture_size:
    case interface::Host::mip_level:
    case interface::Host::sample_closest:
    case interface::Host::sample_linear:
    case interface::Host::sample_trilinear: return true;
    case interface::Host::light_change:
    case interface::Host::environment:
    case interface::Host::irradiance:
    case interface::Host::depth:
    case interface::Host::image: return false;
  }
  return false;
}

class Judge {
 public:
  Judge(const check::TypedGraph& graph, size_t pass, functions::Tier tier)
      : graph_(graph), lowered_(lower::lower(graph, {pass})), tier_(tier) {}

  BlackLights judge() {
    BlackLights judged = try_without({});
    if (!judged.add_nothing) return judged;
    // A normal that is interpolated may be 0, and so the direction to a light at the point itself.
    const std::vector<std::string> directions = std::move(directions_);
    if (directions.size() > most_directions) return {false, "it depends on too many directions"};
    if (operations_ << directions.size() > most_operations) return {false, "it is too long"};
    for (size_t zeros = 1; zeros < size_t{1} << directions.size() && judged.add_nothing; ++zeros) {
      std::vector<std::string> without;
      for (size_t d = 0; d < directions.size(); ++d)
        if ((zeros >> d & 1) != 0) without.push_back(directions[d]);
      judged = try_without(without);
    }
    return judged;
  }

 private:
  /// Where these directions are 0.
  BlackLights try_without(const std::vector<std::string>& zeros) {
    const auto given = [&](Given g) {
      if (!g.unit || std::ranges::find(zeros, g.name) == zeros.end()) return g;
      g.lo = g.hi = 0;
      g.unit = false;
      return g;
    };
    std::vector<Given> givens;
    for (const interface::Binding& binding : lowered_.interface.bindings)
      givens.push_back(given(given_of(graph_, binding)));
    const auto outside = [&](uint32_t function) {
      const interface::HostFunction* host = lowered_.interface.find(function);
      if (host == nullptr) return std::vector<Given>();
      std::vector<Given> answers = answer_of(host->host);
      for (Given& answer : answers) {
        answer = given(answer);
        if (!is_ordinary(host->host)) answer.name = unusual + answer.name;
        if (host->host == interface::Host::light && answer.name == "light.color") answer.lo = answer.hi = 0;
      }
      return answers;
    };
    const auto tape = make_tape_of_terms(lowered_.module, lowered_.interface.entry, givens, outside, tier_);
    if (!tape) return {false, "it is too long, or does not only add up what lights give"};
    if (tape->outputs.empty()) return {true, ""};
    operations_ = tape->operations.size();
    const Proof proof = prove(*tape, effort);
    if (proof.vacuous || proof.unfinished || !proof.unproved.empty() || !proof.later.empty()) {
      const uint32_t place =
          proof.unproved.empty() ? 0 : tape->operations[proof.unproved.front().operation].place;
      return {false, "\"" + tape->places[place].node + "\" may not be finite"};
    }
    for (const Bound& bound : proof.outputs)
      if (bound.lo != 0 || bound.hi != 0) return {false, "a light adds something where its colour is 0"};
    return look_at_inputs(*tape);
  }

  /// Whether every input that matters is ordinary. Collects the directions among them.
  BlackLights look_at_inputs(const Tape& tape) {
    const lanes::FpGuard guard;
    Evaluator evaluator(tape);
    evaluator.walk(evaluator.whole());
    std::vector<const interface::Binding*> binding_of_input;
    for (const interface::Binding& binding : lowered_.interface.bindings)
      binding_of_input.resize(binding_of_input.size() + binding.parameter.type.width, &binding);
    std::vector<bool> matters(tape.operations.size());
    for (const Tape::Output& output : tape.outputs) matters[output.operation] = true;
    for (auto o = static_cast<uint32_t>(tape.operations.size()); o-- > 0;) {
      const Operation& operation = tape.operations[o];
      if (!matters[o] || !evaluator.is_reached(o)) continue;
      // A host answers within the same range whatever it is asked: samplers take infinities and NaN, too.
      const size_t known = operation.kind == Kind::asked ? 1 : operation.count;
      for (const uint32_t operand : tape.operands_of(operation).first(known)) matters[operand] = true;
      if (operation.kind != Kind::input) continue;
      const Input& input = tape.inputs[operation.index];
      const bool is_bound = operation.index < binding_of_input.size();
      const bool is_answer = !is_bound && !input.name.starts_with(unusual) && !input.name.starts_with("dd");
      if (is_bound ? !is_ordinary(*binding_of_input[operation.index]) : !is_answer)
        return {false, "it depends on " + input.name};
      if (input.vector == operation.index) directions_.push_back(input.name.substr(0, input.name.rfind('.')));
    }
    std::ranges::sort(directions_);
    directions_.erase(std::ranges::unique(directions_).begin(), directions_.end());
    return {true, ""};
  }

  /// Begins the names of answers that may be anything.
  static constexpr const char* unusual = "unusual ";

  const check::TypedGraph& graph_;
  const lower::Lowered lowered_;
  const functions::Tier tier_;
  std::vector<std::string> directions_;  ///< that the terms depend on
  size_t operations_ = 0;  ///< of the last proof
};

}  // namespace

BlackLights judge_black_lights(const check::TypedGraph& graph, size_t pass, functions::Tier tier) {
  return Judge(graph, pass, tier).judge();
}

}  // namespace isoshade::prove
