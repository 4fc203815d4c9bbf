// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/explain.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <map>
#include <optional>

#include "compiler/ir/call_graph.h"
#include "compiler/ir/expansion.h"
#include "compiler/support/assert.h"
#include "compiler/support/parse_number.h"

namespace isoshade::driver {

namespace {

/// What a shader has of each node of its document.
class Remains {
 public:
  explicit Remains(const Shader& shader)
      : module_(shader.pure.module), document_(shader.pure.document), branched_(module_.functions.size()) {
    std::vector<uint32_t> entries;
    for (const emit::PureFunction& function : shader.pure.functions) {
      entries.push_back(function.entry);
      const std::vector<uint64_t> sizes = ir::expanded_operations(module_, function.entry);
      total_ += sizes[function.entry];
      for (size_t f = 0; f < sizes.size(); ++f)
        if (sizes_.size() <= f || sizes_[f] == 0) {
          sizes_.resize(std::max(sizes_.size(), f + 1));
          sizes_[f] = sizes[f];
        }
    }
    const auto order = ir::callees_first(module_, entries);
    support::assert_that(order.has_value(), "a function calls itself");
    for (const uint32_t f : *order) {
      const ir::Function& function = module_.functions[f];
      if (function.is_declaration()) continue;
      const uint64_t branched = count(function, 0, false);
      // No choice of a graph makes the branches of a library function.
      if (!function.document.empty()) branched_[f] = branched;
      if (function.document == document_) read_constants(function);
    }
  }

  uint64_t total() const { return total_; }
  uint64_t operations(const std::string& node) const { return found(operations_, node); }
  uint64_t branched(const std::string& node) const { return found(branched_of_nodes_, node); }
  std::string constant(const std::string& node) const {
    const auto found = constants_.find(node);
    return found == constants_.end() ? "" : found->second;
  }

 private:
  static uint64_t found(const std::map<std::string, uint64_t>& counts, const std::string& node) {
    const auto found = counts.find(node);
    return found == counts.end() ? 0 : found->second;
  }

  /// Counts the operations of a block for the nodes of the document. Returns those that one side of a branch has: all, if the
  /// block is `in_branch`.
  uint64_t count(const ir::Function& function, ir::BlockId block, bool in_branch) {
    uint64_t branched = 0;
    for (const ir::InstructionId id : function.blocks[block].instructions) {
      const ir::Instruction& made = function.instructions[id];
      for (const ir::BlockId inner : made.blocks)
        if (inner != ir::none) branched += count(function, inner, in_branch || made.op == ir::Opcode::branch);
      if (made.blocks[0] != ir::none) continue;
      const uint64_t operations = ir::expanded_operations(function, made, sizes_);
      const uint64_t of_callee = made.op == ir::Opcode::call ? branched_[made.imm] : 0;
      const uint64_t of_branches = in_branch ? operations : of_callee;
      branched += of_branches;
      if (function.document != document_) continue;
      operations_[function.origins[made.origin].node] += operations;
      branched_of_nodes_[function.origins[made.origin].node] += of_branches;
    }
    return branched;
  }

  void read_constants(const ir::Function& function) {
    std::vector<ir::InstructionId> made_by(function.values.size(), ir::none);
    for (const ir::Block& block : function.blocks)
      for (const ir::InstructionId id : block.instructions)
        for (uint32_t k = 0; k < function.instructions[id].result_count; ++k)
          made_by[function.instructions[id].first_result + k] = id;
    for (ir::ValueId value = 0; value < function.values.size(); ++value) {
      const uint32_t names = function.values[value].names;
      if (names == 0) continue;
      if (const auto text = constant_of(function, made_by, value)) constants_[function.origins[names].node] = *text;
    }
  }

  static std::optional<std::string> constant_of(const ir::Function& function, const std::vector<ir::InstructionId>& made_by,
                                                ir::ValueId value) {
    if (made_by[value] == ir::none) return std::nullopt;
    const ir::Instruction& made = function.instructions[made_by[value]];
    if (made.op == ir::Opcode::constant) {
      const ir::Type type = function.type(value);
      if (type == ir::bool_type) return made.imm != 0 ? "true" : "false";
      if (type == ir::int_type) return std::to_string(static_cast<int32_t>(made.imm));
      return support::format_float(std::bit_cast<float>(made.imm));
    }
    if (made.op == ir::Opcode::hidden_zero) return "0";
    if (made.op != ir::Opcode::construct) return std::nullopt;
    std::string text;
    for (const ir::ValueId component : function.operands_of(made)) {
      const auto one = constant_of(function, made_by, component);
      if (!one) return std::nullopt;
      text += (text.empty() ? "[" : ", ") + *one;
    }
    return text + "]";
  }

  const ir::Module& module_;
  const std::string& document_;
  uint64_t total_ = 0;
  std::vector<uint64_t> sizes_, branched_;  ///< by function
  std::map<std::string, uint64_t> operations_, branched_of_nodes_;
  std::map<std::string, std::string> constants_;
};

}  // namespace

std::set<std::string> Explanation::left_out() const {
  std::set<std::string> ids;
  for (const NodeFate& node : nodes)
    if (node.after == 0 && node.before != 0) ids.insert(node.id);
  return ids;
}

Explanation explain(const Shader& general, const Shader& fixed) {
  const Remains before(general), after(fixed);
  Explanation explanation{before.total(), after.total(), {}};
  for (const graph::Node& node : general.typed->graph.nodes) {
    if (node.id.empty()) continue;
    const auto is_same = [&](const NodeFate& other) { return other.id == node.id; };
    if (std::ranges::any_of(explanation.nodes, is_same)) continue;
    const bool is_expression = node.origin != graph::Node::Origin::node;
    NodeFate fate{node.id, is_expression ? "expression" : node.type, before.operations(node.id),
                  after.operations(node.id), "", before.branched(node.id), after.branched(node.id)};
    if (fate.after == 0) fate.value = after.constant(node.id);
    explanation.nodes.push_back(std::move(fate));
  }
  return explanation;
}

std::string text(const Explanation& explanation, const Shader& fixed) {
  std::string text = fmt::format("{} {}", graph::kind_name(fixed.kind), fixed.pure.name);
  const auto list = [&](std::string_view title, const auto& belongs, const auto& end_of_line) {
    std::string lines;
    for (const NodeFate& node : explanation.nodes)
      if (belongs(node)) lines += fmt::format("  {:<24} {:<24} {}\n", node.id, node.type, end_of_line(node));
    if (!lines.empty()) text += fmt::format("{}:\n{}", title, lines);
  };
  std::string values;
  for (size_t field = 0; field < fixed.parameters.fields.size(); ++field)
    if (is_fixed(fixed.fixed, fixed.parameters, field))
      values += (values.empty() ? " for fixed " : ", ") + fixed.parameters.fields[field].name;
  text += values + fmt::format(": {} operations, {} without fixed values\n", explanation.after, explanation.before);
  list("computed", [](const NodeFate& node) { return node.after != 0; },
       [](const NodeFate& node) {
         return node.after == node.before ? fmt::format("{} operations", node.after)
                                          : fmt::format("{} operations, {} without fixed values", node.after, node.before);
       });
  list("constant", [](const NodeFate& node) { return node.after == 0 && !node.value.empty(); },
       [](const NodeFate& node) { return node.value; });
  list("left out", [](const NodeFate& node) { return node.after == 0 && node.value.empty() && node.before != 0; },
       [](const NodeFate& node) { return fmt::format("{} operations, whose result nothing needs", node.before); });
  return text;
}

}  // namespace isoshade::driver
