#include "terrain_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::bench {
namespace {

constexpr int kCorners = 200;      // along each side
constexpr double kHalfSide = 5.0;  // [m]

std::string Humanoid() {
  std::string sides;
  for (const auto& [name, y] : {std::pair("left", "1"), std::pair("right", "-1")}) {
    const std::string side = name, sign = y[0] == '-' ? "-" : "";
    sides += R"(<body name=")" + side + R"(_thigh" pos="0 )" + sign + R"(.1 -.04">
      <joint name=")" +
             side + R"(_hip_x" axis="1 0 0" range="-25 25"/>
      <joint name=")" +
             side + R"(_hip_z" axis="0 0 1" range="-40 40"/>
      <joint name=")" +
             side + R"(_hip_y" axis="0 1 0" range="-110 20"/>
      <geom type="capsule" size=".06" fromto="0 0 0 0 0 -.34"/>
      <body pos="0 0 -.4"><joint name=")" +
             side + R"(_knee" axis="0 1 0" range="2 140"/>
      <geom type="capsule" size=".049" fromto="0 0 0 0 0 -.3"/>
      <body pos="0 0 -.39">
      <joint name=")" +
             side + R"(_ankle_y" axis="0 1 0" range="-50 50"/>
      <joint name=")" +
             side + R"(_ankle_x" axis="1 0 0" range="-30 30"/>
      <geom type="box" size=".11 .045 .02" pos=".05 0 -.04"/></body></body></body>)";
  }
  std::string arms;
  for (const auto& [name, y] : {std::pair("left", "1"), std::pair("right", "-1")}) {
    const std::string side = name, sign = y[0] == '-' ? "-" : "";
    arms += R"(<body name=")" + side + R"(_arm" pos="0 )" + sign + R"(.19 .3">
      <joint axis="1 0 0" range="-90 90"/><joint axis="0 1 0" range="-150 60"/>
      <joint axis="0 0 1" range="-60 60"/>
      <geom type="capsule" size=".04" fromto="0 )" +
            sign + ".02 0 0 " + sign + R"(.05 -.24"/>
      <body pos="0 )" +
            sign + R"(.05 -.29"><joint axis="0 1 0" range="-130 0"/>
      <geom type="capsule" size=".031" fromto="0 0 0 0 0 -.2"/>
      <geom size=".04" pos="0 0 -.26"/></body></body>)";
  }
  return R"(<body name="pelvis" pos="0 0 1.2"><freejoint/>
      <geom type="capsule" size=".09" fromto="0 -.07 0 0 .07 0"/>)" +
         sides + R"(<body name="waist" pos="0 0 .14">
      <joint axis="0 1 0" range="-75 30"/><joint axis="1 0 0" range="-35 35"/>
      <geom type="capsule" size=".07" fromto="0 -.05 0 0 .05 0"/>
      <body name="chest" pos="0 0 .08"><joint axis="0 0 1" range="-45 45"/>
      <geom type="box" size=".09 .13 .14" pos="0 0 .2"/>
      <body pos="0 0 .4"><joint axis="0 1 0" range="-40 40"/><joint axis="0 0 1" range="-60 60"/>
      <joint axis="1 0 0" range="-30 30"/><geom size=".1" pos="0 0 .12"/></body>)" +
         arms + "</body></body></body>";
}

std::string Quadruped() {
  std::string legs;
  for (const std::string x : {"", "-"}) {
    for (const std::string y : {"", "-"}) {
      legs += R"(<body pos=")" + x + ".23 " + y + R"(.06 0">
        <joint axis="1 0 0" range="-50 50"/>
        <geom type="cylinder" size=".045 .03" pos="0 )" +
              y + R"(.05 0" euler="90 0 0"/>
        <body pos="0 )" +
              y + R"(.1 0"><joint axis="0 1 0" range="-60 150"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 0 -.21"/>
        <body pos="0 0 -.25"><joint axis="0 1 0" range="-150 -50"/>
        <geom type="capsule" size=".018" fromto="0 0 0 0 0 -.2"/>
        <geom size=".025" pos="0 0 -.23"/></body></body></body>)";
    }
  }
  return R"(<body name="trunk" pos="0 0 .6"><freejoint/>
      <geom type="box" size=".3 .1 .07"/>)" +
         legs + "</body>";
}

// Heights [m] of a ground at x, y; `noise` is uniform in [0, 1].
double HeightAt(const std::string& ground, double x, double y, double noise) {
  if (ground == "waves") {
    const double k = 2.0 * M_PI / 1.6;
    return 0.075 * std::sin(k * x) * std::cos(0.6 * k * y) + 0.03 * std::sin(1.7 * k * y);
  }
  if (ground == "stairs") return 0.12 * std::floor((kHalfSide - std::abs(x)) / 0.4);
  return 0.05 * noise + 0.1 * std::sin(0.9 * x + 0.4 * y);
}

std::string FieldAsset(const std::string& ground) {
  std::mt19937_64 random(25);
  std::vector<double> heights;
  for (int row = 0; row < kCorners; ++row) {
    for (int col = 0; col < kCorners; ++col) {
      const double x = kHalfSide * (2.0 * col / (kCorners - 1) - 1.0);
      const double y = kHalfSide * (2.0 * row / (kCorners - 1) - 1.0);
      heights.push_back(HeightAt(ground, x, y, static_cast<double>(random() >> 11) * 0x1p-53));
    }
  }
  const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
  std::string elevation;
  std::array<char, 32> text;
  for (const double h : heights) {
    std::snprintf(text.data(), text.size(), "%.6g ", h - *least);
    elevation += text.data();
  }
  std::snprintf(text.data(), text.size(), "%.6g", *most - *least);
  return "<hfield name='ground' nrow='" + std::to_string(kCorners) + "' ncol='" +
         std::to_string(kCorners) + "' size='5 5 " + text.data() + " 1' elevation='" + elevation +
         "'/>";
}

}  // namespace

std::vector<std::string> TerrainRobots() { return {"humanoid", "quadruped"}; }
std::vector<std::string> Grounds() { return {"plane", "waves", "stairs", "noise"}; }

std::string TerrainXml(const std::string& robot, const std::string& ground) {
  const bool plane = ground == "plane";
  return "<mujoco><compiler angle='degree'/><asset>" + (plane ? "" : FieldAsset(ground)) +
         "</asset><worldbody><geom name='ground' " +
         (plane ? "type='plane' size='0 0 1'" : "type='hfield' hfield='ground'") + "/>" +
         (robot == "humanoid" ? Humanoid() : Quadruped()) + "</worldbody></mujoco>";
}

}  // namespace mjcf_pdg::bench
