#include "bound/parting_rows.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {

void PartingRows::Begin(std::span<const Mover> movers, double length, int pairs) {
  all_ = movers;
  length_ = length;
  pairs_.clear();
  movers_.clear();
  columns_.clear();
  number_.assign(movers.size(), -1);
  used_.clear();
  coordinates_.clear();
  dims_ = 0;
  rows_.clear();
  values_.clear();
  bends_.clear();
  crosses_.clear();
  pairs_.reserve(pairs);
  movers_.reserve(pairs * movers.size());
  columns_.reserve(Coordinates::kMost * pairs * movers.size());
  used_.reserve(movers.size());
  coordinates_.reserve(movers.size());
}

void PartingRows::Reserve(int rows, int middles) {
  std::size_t columns = 0, movers = 0;
  for (const Pair& pair : pairs_) {
    columns = std::max<std::size_t>(columns, pair.size);
    movers = std::max<std::size_t>(movers, pair.end - pair.movers);
  }
  rows_.reserve(rows + middles);
  values_.reserve((rows + middles) * columns);
  bends_.reserve(rows * movers);
  crosses_.reserve(rows * movers * movers / 2);
}

int PartingRows::Use(int mover) {
  if (number_[mover] >= 0) return number_[mover];
  number_[mover] = static_cast<int>(used_.size());
  Used& used = used_.emplace_back();
  used.mover = &all_[mover];
  Coordinates at{.at = dims_};
  if (used.mover->hinge) {
    at.turns = 1;
  } else if (used.mover->turn == 0.0) {
    at.slides = 1;
  } else {
    at.slides = used.mover->slide > 0.0 ? 3 : 0;
    at.turns = 3;
    used.factor = Eigen::LLT<Matrix3d>(used.mover->C).matrixL();
  }
  coordinates_.push_back(at);
  dims_ += at.size();
  return number_[mover];
}

int PartingRows::AddPair(const PairProblem& problem, std::span<const int> own1,
                         std::span<const int> own2) {
  Pair& pair = pairs_.emplace_back();
  pair.problem = &problem;
  pair.movers = static_cast<int>(movers_.size());
  pair.columns = static_cast<int>(columns_.size());
  pair.split = pair.movers + static_cast<int>(own1.size());
  for (const std::span<const int> own : {own1, own2}) {
    for (const int mover : own) {
      const int used = Use(mover);
      movers_.push_back(used);
      for (int k = 0; k < coordinates_[used].size(); ++k) {
        columns_.push_back(coordinates_[used].at + k);
      }
    }
  }
  pair.end = static_cast<int>(movers_.size());
  pair.size = static_cast<int>(columns_.size()) - pair.columns;
  return num_pairs() - 1;
}

// Appends g.
void PartingRows::AddGradient(const Pair& pair, const Vector3d& n, PartingRow& row) {
  row.values = static_cast<int>(values_.size());
  values_.resize(values_.size() + pair.size);
  double* g = values_.data() + row.values;
  for (int k = pair.movers; k < pair.end; ++k) {
    const Mover& mover = *used_[movers_[k]].mover;
    const Vector3d toward = k < pair.split ? Vector3d(-n) : n;
    const Vector3d r = (k < pair.split ? row.a : row.b) - mover.anchor;
    if (mover.hinge) {
      *g++ = mover.turn * toward.dot(mover.axis.cross(r));
    } else if (mover.turn == 0.0) {
      *g++ = mover.slide * toward.dot(mover.axis);
    } else {
      const Vector3d turned = used_[movers_[k]].factor.transpose() * r.cross(toward);
      if (mover.slide > 0.0) {
        for (int c = 0; c < 3; ++c) *g++ = mover.slide * toward[c];
      }
      for (int c = 0; c < 3; ++c) *g++ = turned[c];
    }
  }
  row.gg = Eigen::Map<const Eigen::VectorXd>(g - pair.size, pair.size).squaredNorm();
}

int PartingRows::AddMiddle(int pair, const Vector3d& n, const Vector3d& a, const Vector3d& b) {
  PartingRow row{a, b};
  row.t = row.t_middle = problem(pair).required + n.dot(a - b);
  AddGradient(pairs_[pair], n, row);
  rows_.push_back(row);
  return static_cast<int>(rows_.size()) - 1;
}

// For the point p and a cap of unit vectors that are no farther than `wide` from n.
void PartingRows::AddBend(const Used& used, const Vector3d& n, double wide, const Vector3d& p) {
  const Mover& mover = *used.mover;
  Bend& B = bends_.emplace_back(Bend::Zero());
  const Vector3d r = p - mover.anchor;
  if (mover.hinge) {
    const Vector3d across = r - mover.axis.dot(r) * mover.axis;
    B(0, 0) = mover.turn * mover.turn * (wide * across.norm() - n.dot(across));
  } else if (mover.turn > 0.0) {
    B = 0.5 * (n * r.transpose() + r * n.transpose());
    B.diagonal().array() += wide * r.norm() - n.dot(r);
    B = used.factor.transpose() * B * used.factor;
  }
}

// Of the movers i < j of a geom's chain: as i turns, it carries what j moves p by. That is at most
// turn_i ρ_j |x_i| |x_j|. It is also n·(w_i×s_j), of which we have the coefficient, up to what is
// of third order: of R_i by ½ |w_i|², of the R_k between by |w_k| each, and of s_j by ½ |w_j|² |r|.
void PartingRows::AddCrosses(int begin, int end, const Vector3d& n, double wide,
                             const Vector3d& p) {
  for (int j = begin + 1; j < end; ++j) {
    const Used& carried = used_[movers_[j]];
    const Mover& b = *carried.mover;
    const Vector3d r = p - b.anchor;
    const double reach = std::sqrt(ReachSquared(b, p, 0.0));
    const double own = 0.5 * b.turn * b.turn * (b.hinge ? b.axis.cross(r) : r).norm();
    // |v·s_j| per |x_j|, to first order
    const auto along = [&](const Vector3d& v) {
      if (b.hinge) return b.turn * std::abs(v.dot(b.axis.cross(r)));
      if (b.turn == 0.0) return b.slide * std::abs(v.dot(b.axis));
      const double turned = (carried.factor.transpose() * r.cross(v)).squaredNorm();
      return std::sqrt(b.slide * b.slide * v.squaredNorm() + turned);
    };
    const std::size_t first = crosses_.size();
    crosses_.resize(first + (j - begin));
    double between = 0.0;  // of the R_k, squared
    for (int i = j - 1; i >= begin; --i) {
      const Used& carrier = used_[movers_[i]];
      const Mover& a = *carrier.mover;
      double& cross = crosses_[first + (i - begin)];
      if (a.turn == 0.0) continue;
      double as_it_is = 0.0;
      if (a.hinge) {
        as_it_is = a.turn * along(n.cross(a.axis));
      } else {
        for (int c = 0; c < 3; ++c)
          as_it_is = std::hypot(as_it_is, along(n.cross(carrier.factor.col(c))));
      }
      const double turns = length_ * std::sqrt(between + 0.25 * a.turn * a.turn);
      const double rest = a.turn * ((wide + turns) * reach + own * length_);
      cross = std::min(a.turn * reach, as_it_is + rest);
      between += a.turn * a.turn;
    }
  }
}

int PartingRows::AddRow(int number, const Vector3d& n, double eps, const Vector3d& a,
                        const Vector3d& b) {
  const Pair& pair = pairs_[number];
  PartingRow row{a, b};
  row.t = pair.problem->Overlap(a - b, n, eps);
  row.t_middle = pair.problem->required + n.dot(a - b);
  AddGradient(pair, n, row);
  const double wide = 2.0 * std::sin(0.5 * eps);  // how far the unit vectors are from n
  row.e = eps > 0.0 ? wide * pair.problem->MostGamma(a, b) : 0.0;
  row.bends = static_cast<int>(bends_.size());
  for (int k = pair.movers; k < pair.end; ++k) {
    const bool of1 = k < pair.split;
    AddBend(used_[movers_[k]], of1 ? Vector3d(-n) : n, wide, of1 ? a : b);
  }
  row.crosses = static_cast<int>(crosses_.size());
  AddCrosses(pair.movers, pair.split, n, wide, a);
  AddCrosses(pair.split, pair.end, n, wide, b);
  rows_.push_back(row);
  return static_cast<int>(rows_.size()) - 1;
}

void PartingRows::DropLast() {
  values_.resize(rows_.back().values);
  bends_.resize(rows_.back().bends);
  crosses_.resize(rows_.back().crosses);
  rows_.pop_back();
}

double PartingRows::Dot(int pair, const PartingRow& row, const Eigen::VectorXd& x) const {
  const double* g = values_.data() + row.values;
  const int* column = columns_.data() + pairs_[pair].columns;
  double sum = 0.0;
  for (int k = 0; k < pairs_[pair].size; ++k) sum += g[k] * x[column[k]];
  return sum;
}

void PartingRows::AddTo(int pair, const PartingRow& row, double factor, Eigen::VectorXd& x) const {
  const double* g = values_.data() + row.values;
  const int* column = columns_.data() + pairs_[pair].columns;
  for (int k = 0; k < pairs_[pair].size; ++k) x[column[k]] += factor * g[k];
}

// The sum of the rotations w of some movers.
Vector3d PartingRows::Turn(int begin, int end, const Eigen::VectorXd& x) const {
  Vector3d w = Vector3d::Zero();
  for (int k = begin; k < end; ++k) {
    const Used& used = used_[movers_[k]];
    const Coordinates& at = coordinates_[movers_[k]];
    const int turn = at.at + at.slides;
    if (at.turns == 1) w += used.mover->turn * x[turn] * used.mover->axis;
    if (at.turns == 3) w += used.factor * x.segment<3>(turn);
  }
  return w;
}

std::pair<Vector3d, Vector3d> PartingRows::Deepest(int number, const Vector3d& n,
                                                   const Eigen::VectorXd& x) const {
  const Pair& pair = pairs_[number];
  const Vector3d n1 = n + n.cross(Turn(pair.movers, pair.split, x));
  const Vector3d n2 = n + n.cross(Turn(pair.split, pair.end, x));
  return pair.problem->FarthestAlong(n, n1.normalized(), n2.normalized());
}

template <typename Visit>
void PartingRows::ForEachCross(const Pair& pair, const PartingRow& row, const Visit& visit) const {
  const double* cross = crosses_.data() + row.crosses;
  for (const auto& [begin, end] :
       {std::pair(pair.movers, pair.split), std::pair(pair.split, pair.end)}) {
    for (int j = begin + 1; j < end; ++j) {
      for (int i = begin; i < j; ++i) visit(movers_[i], movers_[j], *cross++);
    }
  }
}

void PartingRows::AddBends(int number, const PartingRow& row, double factor,
                           std::span<BendBlock> bends, Eigen::Map<Eigen::MatrixXd>& crosses) const {
  const Pair& pair = pairs_[number];
  ForEachCross(pair, row, [&](int i, int j, double size) {
    crosses(i, j) += factor * size;
    crosses(j, i) += factor * size;
  });
  const Bend* bend = bends_.data() + row.bends;
  for (int k = pair.movers; k < pair.end; ++k) bends[movers_[k]].B += factor * *bend++;
}

double PartingRows::BendAlong(int number, const PartingRow& row, const Eigen::VectorXd& lengths,
                              const Eigen::VectorXd& x) const {
  const Pair& pair = pairs_[number];
  double sum = 0.0;
  ForEachCross(pair, row,
               [&](int i, int j, double size) { sum += size * lengths[i] * lengths[j]; });
  const Bend* bend = bends_.data() + row.bends;
  for (int k = pair.movers; k < pair.end; ++k, ++bend) {
    const Coordinates& at = coordinates_[movers_[k]];
    const int turn = at.at + at.slides;
    if (at.turns == 1) sum += 0.5 * (*bend)(0, 0) * x[turn] * x[turn];
    if (at.turns == 3) sum += 0.5 * x.segment<3>(turn).dot(*bend * x.segment<3>(turn));
  }
  return sum;
}

}  // namespace mjcf_pdg
