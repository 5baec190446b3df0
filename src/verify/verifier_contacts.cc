// What the verifier does with MuJoCo's contacts: they decide where there are no certificates.
//
// Part of verifier.h.
#include <algorithm>
#include <utility>

#include "verify/sdf_pair.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

using verify::CheckedPair;
using verify::Finding;
using verify::PosedPair;
using verify::Proof;
using verify::Reading;

// Sets the margins and gaps of the private model to zero. MuJoCo detects contacts nearer than
// margin + gap; the overlap that a negative sum allows is in CheckedPair::allowed. SDFs get the
// largest required distance as their margin, so that contacts tell of pairs that are nearer.
void Verifier::NeutraliseMargins() {
  geom_margin_.assign(model_.ngeom, 0.0);
  body_margin_.assign(model_.nbody, 0.0);
  pair_margin_.assign(model_.npair, 0.0);
  no_gap_.assign(std::max(model_.ngeom, model_.npair), 0.0);
  for (int g = 0; g < model_.ngeom; ++g) {
    if (!verify::IsSdf(model_.geom_type[g])) continue;
    geom_margin_[g] = reach_;
    body_margin_[model_.geom_bodyid[g]] = reach_;
  }
  for (int k = 0; k < model_.npair; ++k) {
    if (verify::IsSdf(model_.geom_type[model_.pair_geom1[k]]) ||
        verify::IsSdf(model_.geom_type[model_.pair_geom2[k]])) {
      pair_margin_[k] = reach_;
    }
  }
  model_.geom_margin = geom_margin_.data();
  model_.geom_gap = no_gap_.data();
  model_.body_margin = body_margin_.data();
  model_.pair_margin = pair_margin_.data();
  model_.pair_gap = no_gap_.data();
}

// Runs mj_collision at the current pose and finds the deepest contact of each pair. If the arena is
// full, MuJoCo drops contacts and only counts a warning.
void Verifier::AskCollision() {
  mjData& d = *data_;
  d.warning[mjWARN_CONTACTFULL].number = 0;
  mj_collision(&model_, &d);
  findings_.arena_full = d.warning[mjWARN_CONTACTFULL].number > 0;
  for (const int pair : touching_) contact_[pair] = -1;
  touching_.clear();
  contacts_of_other_pairs_.clear();
  int last = -1;  // MuJoCo's contacts are sorted by pairs of bodies
  for (int c = 0; c < d.ncon; ++c) {
    const int pair = PairIndex(d.contact[c].geom[0], d.contact[c].geom[1], last);
    if (pair >= 0) last = pair;
    if (pair < 0) {
      const std::pair<int, int> geoms = std::minmax(d.contact[c].geom[0], d.contact[c].geom[1]);
      if (!shared_->left_out.contains(geoms)) contacts_of_other_pairs_.push_back(c);
      continue;
    }
    int& deepest = contact_[pair];
    if (deepest < 0) touching_.push_back(pair);
    if (deepest < 0 || !(d.contact[c].dist >= d.contact[deepest].dist)) deepest = c;
  }
  std::sort(touching_.begin(), touching_.end());
}

// Adds what MuJoCo's contacts alone decide: pairs with SDFs, and pairs of geoms that
// shared_->pairs lacks.
void Verifier::CheckContacts() {
  const mjData& d = *data_;
  const auto report = [&](const mjContact& contact, const Finding& as) {
    if (contact.dist >= as.required + tolerance_) return;
    Finding finding = as;
    verify::SetFromContact(contact, finding.contact);
    finding.violates = !(contact.dist >= as.required - tolerance_);
    verdict_.min_distance = std::min(verdict_.min_distance, contact.dist);
    auto same = [&](const Finding& f) { return f.contact.geom == finding.contact.geom; };
    const auto known = std::find_if(findings_.pairs.begin(), findings_.pairs.end(), same);
    if (known == findings_.pairs.end()) {
      findings_.pairs.push_back(finding);
    } else if (contact.dist < known->contact.distance) {
      *known = finding;
    }
  };
  for (const int k : touching_) {
    const CheckedPair& pair = shared_->pairs[k];
    if (!pair.sdf) continue;
    verdict_.min_distance = std::min(verdict_.min_distance, d.contact[contact_[k]].dist);
    Finding finding;
    finding.contact.geom = {pair.geom1, pair.geom2};
    finding.required = required_[k];
    finding.frozen = !pair.separable;
    report(d.contact[contact_[k]], finding);
  }
  for (const int c : contacts_of_other_pairs_) {
    Finding finding;
    finding.contact.geom = {d.contact[c].geom[0], d.contact[c].geom[1]};
    report(d.contact[c], finding);
  }
}

// Pairs with an SDF by the geoms' own functions, too: where MuJoCo's search for contacts finds
// none, they may overlap all the same.
void Verifier::CheckFields() {
  if (!shared_->has_sdf_pairs) return;
  for (int k = 0; k < static_cast<int>(shared_->pairs.size()); ++k) {
    const PosedPair posed = Posed(k);
    if (!posed.pair.sdf || posed.SphereBound() > required_[k] + tolerance_) continue;
    const Reading found = verify::SdfPair(posed).Measure(required_[k] + tolerance_);
    if (!(found.distance < required_[k] + tolerance_)) continue;
    verdict_.min_distance = std::min(verdict_.min_distance, found.distance);
    const bool violates = !(found.distance >= required_[k] - tolerance_);
    const auto same = [&](const Finding& other) {
      return other.contact.geom == std::array{posed.pair.geom1, posed.pair.geom2};
    };
    std::erase_if(findings_.pairs, [&](const Finding& other) {
      return same(other) && other.contact.distance >= found.distance;
    });
    if (std::any_of(findings_.pairs.begin(), findings_.pairs.end(), same)) continue;
    Report(k, found, violates ? Proof::kPoints : Proof::kPlane);
  }
}

void Verifier::FindDisputes() {
  disputed_ = false;
  if (tolerance_ < model_.opt.ccd_tolerance) return;  // contacts are no more accurate
  for (const int k : touching_) {
    const CheckedPair& pair = shared_->pairs[k];
    if (pair.exact || pair.terrain || pair.sdf) continue;
    if (!InScope(pair.geom1, pair.geom2)) continue;
    disputed_ |= data_->contact[contact_[k]].dist < required_[k] - tolerance_;
  }
}

}  // namespace mjcf_pdg
