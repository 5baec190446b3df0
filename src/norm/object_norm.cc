#include "mjcf_pdg/object_norm.h"

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
  for (const NormTerm& term : impl_->evaluator.terms()) {
    NormPart part{impl_->evaluator.TermName(term), impl_->evaluator.TermSigma(term, r)};
    if (part.name == "root" && !parts.empty() && parts.back().name == "root") {
      parts.back().sigma += part.sigma;  // a top body with several joints
    } else {
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace mjcf_pdg
