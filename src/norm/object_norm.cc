#include "mjcf_pdg/object_norm.h"

#include <limits>

#include "norm/norm_evaluator.h"

namespace mjcf_pdg {

struct MJCF_PDG_LOCAL ObjectNorm::Impl {
  Scene scene;
  NormEvaluator evaluator;

  Impl(const Scene& s, Metric metric) : scene(s), evaluator(s.tables(), metric) {}
};

ObjectNorm::ObjectNorm(const Scene& scene, Metric metric, const std::vector<double>& q_in)
    : impl_(std::make_unique<Impl>(scene, metric)) {
  scene.CheckConfiguration(q_in);
  impl_->evaluator.SetReference(ToEigen(q_in));
}

ObjectNorm::~ObjectNorm() = default;
ObjectNorm::ObjectNorm(ObjectNorm&&) noexcept = default;
ObjectNorm& ObjectNorm::operator=(ObjectNorm&&) noexcept = default;

double ObjectNorm::Sigma(const std::vector<double>& q) {
  impl_->scene.CheckConfiguration(q);
  return impl_->evaluator.Sigma(ToEigen(q));
}

std::vector<NormPart> ObjectNorm::Parts(const std::vector<double>& q) {
  impl_->scene.CheckConfiguration(q);
  VectorXd r;
  impl_->evaluator.Residual(ToEigen(q), r);
  std::vector<NormPart> parts;
  std::size_t root = std::numeric_limits<std::size_t>::max();  // which of them is the root link's
  for (const NormTerm& term : impl_->evaluator.terms()) {
    const NormPart part{impl_->evaluator.TermName(term), impl_->evaluator.TermSigma(term, r)};
    if (!impl_->evaluator.OfRootPose(term)) {
      parts.push_back(part);
    } else if (root < parts.size()) {  // joints of the top body, and what their armature adds
      parts[root].sigma += part.sigma;
    } else {
      root = parts.size();
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace mjcf_pdg
