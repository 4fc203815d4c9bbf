// SPDX-License-Identifier: Apache-2.0
#include "compiler/reflect/proofs.h"

#include "compiler/prove/document.h"

namespace isoshade::reflect {

namespace {

/// Of an error bound, what is known.
void set_error(const prove::Bound& bound, Optional<Real>& error, Optional<Real>& ulps) {
  if (bound.absolute > prove::largest) return;
  error = bound.absolute;
  if (bound.relative < 1) ulps = bound.relative / prove::half_ulp;
}

ProvedResult result_of(const prove::Tape& tape, const prove::Proof& proof, size_t output) {
  const prove::Bound& bound = proof.outputs[output];
  ProvedResult result{tape.outputs[output].name, bound.lo, bound.hi, {}, {}, {}, {}};
  set_error(bound, result.error, result.ulps);
  set_error(proof.followed[output], result.followed_error, result.followed_ulps);
  return result;
}

Proof proof_of(const prove::Subject& subject, const prove::Effort& effort) {
  const prove::Proof found = prove::prove(subject.tape, effort);
  const prove::NotProved counts = prove::count(subject, found);
  Proof proof;
  proof.subject = subject.name;
  proof.outcome = !counts.refuted && found.unproved.empty() ? Outcome::proved
                  : counts.refuted                          ? Outcome::refuted
                                                            : Outcome::undecided;
  proof.refuted = static_cast<Integer>(counts.refuted);
  proof.undecided = static_cast<Integer>(counts.undecided + counts.later);
  if (proof.outcome == Outcome::proved)
    for (size_t i = 0; i < found.outputs.size(); ++i)
      proof.results.push_back(result_of(subject.tape, found, i));
  return proof;
}

}  // namespace

std::optional<List<Proof>> proofs_of(const driver::Shader& shader, support::Diagnostics& diagnostics) {
  const check::TypedGraph& graph = *shader.typed;
  const auto subjects = prove::subjects_of(graph, diagnostics, shader.tier, driver::fixing(graph, shader.fixed));
  if (!subjects) return std::nullopt;
  List<Proof> proofs;
  const prove::Effort effort = prove::effort_for(*subjects);
  for (const prove::Subject& subject : *subjects) proofs.push_back(proof_of(subject, effort));
  return proofs;
}

}  // namespace isoshade::reflect
