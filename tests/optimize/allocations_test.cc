// No unit that a solve calls takes anything from the heap once it is warm: each is run at one
// configuration, then at others, while the allocations of this thread are counted.
#include <functional>
#include <memory>

#include "bound/lower_bound.h"
#include "optimize/local_optimization.h"
#include "start/selection.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class AllocationsTest : public MujocoTest {
 protected:
  void SetUp() override {
    if (!AllocationCounter::Works()) GTEST_SKIP() << "no hook into this C library's malloc";
  }

  static Options With(Metric metric) {
    Options options;
    options.metric = metric;
    return options;
  }

  // A problem set up at q_in, where something overlaps.
  struct Posed {
    Posed(const Scene& s, const Options& user) : scene(s), options(user) {}
    const VectorXd& q_in() const { return work.problem().q_in; }

    Scene scene;
    Options options;
    Workspace work{scene.tables(), options};
    const std::vector<NearPair>* overlaps = nullptr;
  };

  // What is made for each of some random robots is called at random configurations, and counted
  // from the second one on.
  using Run = std::function<void()>;
  void ExpectNone(const Options& options, const std::function<Run(Posed&)>& make) {
    Random rng(71);
    int overlapping = 0;
    for (int robot = 0; robot < 6; ++robot) {
      Posed posed(Scene::FromString(RandomRobotXml(rng, {.free_base = robot % 2 == 0})), options);
      const Run run = make(posed);
      for (int k = 0; k < 12; ++k) {
        const VectorXd q_in = RandomConfiguration(posed.scene, rng);
        const AllocationCounter counter;
        posed.work.Begin(q_in);
        posed.overlaps = &posed.work.OverlapsAtInput();
        run();
        if (k > 0) {
          EXPECT_EQ(counter.count(), 0) << "robot " << robot << ", q_in " << Join(q_in);
        }
        overlapping += !posed.overlaps->empty();
      }
    }
    EXPECT_GT(overlapping, 36);
  }
};

TEST_F(AllocationsTest, AreSeenWhoeverAsks) {
  const AllocationCounter counter;
  const auto by_new = std::make_unique<int>(1);
  EXPECT_EQ(counter.count(), 1);
  const VectorXd by_eigen = VectorXd::Zero(*by_new + 5);
  EXPECT_EQ(counter.count(), 2);
#ifndef __SANITIZE_THREAD__  // which does not tell of aligned_alloc
  mju_free(mju_malloc(8));
  EXPECT_EQ(counter.count(), 3) << by_eigen;
#endif
}

TEST_F(AllocationsTest, AreNotMadeByDistancesOfAnyTwoTypesOfGeoms) {
  Random rng(72);
  int near = 0;
  for (const int type1 : ConvexTypes()) {
    for (const int type2 : ConvexTypes()) {
      if (type1 == mjGEOM_PLANE) continue;
      const Scene scene = Scene::FromString(
          TwoGeomXml({.first = RandomShape(type1, rng), .second = RandomShape(type2, rng)}));
      ContactFinder finder(scene.tables());
      for (int k = 0; k < 30; ++k) {
        const VectorXd q = RandomConfiguration(scene, rng, 0.3);
        const AllocationCounter counter;
        if (k % 3 == 0) finder.Forget();
        finder.Pose(q);
        near += static_cast<int>(finder.Find(0.05).size());
        if (k > 0) {
          EXPECT_EQ(counter.count(), 0) << TypeName(type1) << " on " << TypeName(type2);
        }
      }
    }
  }
  EXPECT_GT(near, 300);
}

TEST_F(AllocationsTest, AreNotMadeByTheNorm) {
  struct Scratch {
    VectorXd r, dq, out;
    MatrixXd J, H;
    BlockCholesky whitening;
  };
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    ExpectNone(With(metric), [](Posed& p) {
      return [&p, s = std::make_shared<Scratch>()] {
        NormEvaluator& norm = p.work.norm;
        norm.Linearize(p.q_in(), s->r, s->J);
        norm.InnerProduct(s->J, s->H);
        s->whitening.Factor(s->H, norm.blocks());
        s->dq.setConstant(p.scene.dof(), 0.1);
        s->whitening.SolveLower(s->dq);
        s->whitening.SolveUpper(s->dq);
        norm.Retract(p.q_in(), s->dq, s->out);
        norm.Sigma(s->out);
      };
    });
  }
}

TEST_F(AllocationsTest, AreNotMadeByTheLcp) {
  Random rng(73);
  ActiveSetLcp active_set;
  GaussSeidelLcp gauss_seidel;
  VectorXd lambda(60);
  constexpr int kDofs = 20;
  for (int k = 0; k < 40; ++k) {
    const int m = k == 0 ? 60 : rng.Index(61);  // the largest first
    MatrixXd G(kDofs, m);
    for (int i = 0; i < m; ++i) G.col(i) = rng.Normals(kDofs);
    const VectorXd b = rng.Normals(m), mu = VectorXd::Constant(m, 3.0);
    const AllocationCounter counter;
    active_set.Solve(G, b, mu, {}, lambda.head(m));
    active_set.SolveFrom(G, b, mu, {}, lambda.head(m));
    gauss_seidel.Solve(G, b, mu, {}, lambda.head(m));
    if (k > 0) {
      EXPECT_EQ(counter.count(), 0) << m;
    }
  }
}

TEST_F(AllocationsTest, AreNotMadeByALocalOptimization) {
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    int free = 0, steps = 0;
    ExpectNone(With(metric), [&](Posed& p) {
      auto local = std::make_shared<LocalOptimization>(p.work);
      return [&, local, known = std::make_shared<VectorXd>()] {
        const LocalResult& first = local->Run(p.q_in(), {});
        free += first.free;
        steps += first.iterations;
        *known = first.q;
        LocalOptions again;
        again.known = known.get();
        again.known_sigma = first.sigma;
        local->Run(p.q_in(), again);
      };
    });
    EXPECT_GT(free, 36);
    EXPECT_GT(steps, 300);
  }
}

TEST_F(AllocationsTest, AreNotMadeByTheLowerBound) {
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    int positive = 0;
    ExpectNone(With(metric), [&positive](Posed& p) {
      return [&, bound = std::make_shared<LowerBound>()] {
        positive += bound->Sigma(p.work, *p.overlaps, 100) > 0.0;
      };
    });
    EXPECT_GT(positive, 30);
  }
}

TEST_F(AllocationsTest, AreNotMadeByStarts) {
  mjcf_pdg::Random noise(74);
  int found = 0, translations = 0;
  ExpectNone({}, [&](Posed& p) {
    struct Scratch {
      VectorXd start, far;
    };
    auto starts = std::make_shared<StartSelection>(p.work);
    return [&, starts, s = std::make_shared<Scratch>()] {
      const VectorXd& q_in = p.q_in();
      starts->Gaussian(q_in, 0.01, 3.0, noise, s->start);
      starts->ContactHop(q_in, 0.01, Hop::kFromBest, noise, s->far);
      starts->Mirrored(s->start, s->far);
      starts->Uniform(q_in, noise, s->far);
      starts->Beyond(q_in, s->start, 4.0, s->far);
      found += static_cast<int>(starts->FirstFree(q_in, {&s->far, 1}, 100.0).size());
      translations += static_cast<int>(starts->ConstrainedTranslation(*p.overlaps, q_in).size());
    };
  });
  EXPECT_GT(found, 10);
  EXPECT_GT(translations, 30);
}

}  // namespace
}  // namespace mjcf_pdg::test
