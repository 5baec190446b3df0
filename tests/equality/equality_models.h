// Models with closed loops and couplings.
#ifndef MJCF_PDG_TESTS_EQUALITY_EQUALITY_MODELS_H_
#define MJCF_PDG_TESTS_EQUALITY_EQUALITY_MODELS_H_

namespace mjcf_pdg::test {

// Parallel jaws on a wrist that slides and turns: the right jaw copies the left one. A post stands
// in their way.
inline constexpr char kParallelJaw[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="post" type="cylinder" size=".03 .2" pos=".3 0 0"/>
  <geom name="table" type="box" size=".5 .5 .02" pos="0 0 -.25"/>
  <body name="wrist"><joint name="reach" type="slide" axis="1 0 0" range="-.5 .5"/>
    <joint name="lift" type="slide" axis="0 0 1" range="-.3 .3"/>
    <joint name="turn" axis="0 0 1" range="-2 2"/>
    <geom name="palm" type="box" size=".02 .08 .03" mass="1"/>
    <body name="left" pos=".02 0 0"><joint name="left" type="slide" axis="0 1 0" range=".01 .07"/>
      <geom name="left" type="box" pos=".06 0 0" size=".05 .008 .02" mass=".1"/></body>
    <body name="right" pos=".02 0 0"><joint name="right" type="slide" axis="0 -1 0" range=".01 .07"/>
      <geom name="right" type="box" pos=".06 0 0" size=".05 .008 .02" mass=".1"/></body>
  </body></worldbody>
  <contact><exclude body1="left" body2="right"/></contact>
  <equality><joint joint1="right" joint2="left"/></equality></mujoco>)";

// A four-bar linkage: crank and rocker joined by a coupler, over a floor with a ball on it.
inline constexpr char kFourBar[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="floor" type="plane" size="2 2 .1" pos="0 0 -.25"/>
  <geom name="ball" size=".1" pos=".35 0 .2"/>
  <body name="crank"><joint name="crank" axis="0 1 0"/>
    <geom name="crank" type="capsule" fromto="0 0 0 0 0 .2" size=".015"/>
    <body name="coupler" pos="0 0 .2"><joint name="coupler" axis="0 1 0"/>
      <geom name="coupler" type="capsule" fromto="0 0 0 .5 0 0" size=".015"/></body></body>
  <body name="rocker" pos=".5 0 0"><joint name="rocker" axis="0 1 0"/>
    <geom name="rocker" type="capsule" fromto="0 0 0 0 0 .2" size=".015"/></body>
  </worldbody>
  <contact><exclude body1="coupler" body2="rocker"/><exclude body1="crank" body2="coupler"/></contact>
  <equality><connect name="pin" body1="coupler" body2="rocker" anchor=".5 0 0"/></equality>
  </mujoco>)";

// Two arms of three joints that hold a bar between them, beside a wall.
inline constexpr char kTwoArms[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="wall" type="box" size=".02 .6 .6" pos=".62 0 .3"/>
  <body name="a1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 .3" size=".03"/>
    <body name="a2" pos="0 0 .3"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
      <body name="a3" pos=".3 0 0"><joint axis="0 1 0"/><joint axis="1 0 0"/><geom type="capsule" fromto="0 0 0 .1 0 0" size=".02"/>
        <body name="bar" pos=".15 .2 0"><geom name="bar" type="box" size=".02 .25 .02"/></body></body></body></body>
  <body name="b1" pos="0 .4 0"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 .3" size=".03"/>
    <body name="b2" pos="0 0 .3"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
      <body name="b3" pos=".3 0 0"><joint axis="0 1 0"/><joint axis="1 0 0"/><geom type="capsule" fromto="0 0 0 .1 0 0" size=".02"/></body></body></body>
  </worldbody>
  <equality><weld name="grip" body1="bar" body2="b3"/></equality></mujoco>)";

// Two fingers of two joints each whose lower joints follow the upper ones by a polynomial, and
// whose sums are coupled by tendons.
inline constexpr char kCoupledFingers[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="cup" type="cylinder" size=".04 .1" pos="0 0 .12"/>
  <body name="l1" pos="-.06 0 0"><joint name="l1" axis="0 1 0" range="-1 1"/>
    <geom name="l1" type="capsule" fromto="0 0 .01 0 0 .09" size=".012"/>
    <body name="l2" pos="0 0 .1"><joint name="l2" axis="0 1 0" range="-1.6 1.6"/>
      <geom name="l2" type="capsule" fromto="0 0 .01 0 0 .08" size=".01"/></body></body>
  <body name="r1" pos=".06 0 0"><joint name="r1" axis="0 -1 0" range="-1 1"/>
    <geom name="r1" type="capsule" fromto="0 0 .01 0 0 .09" size=".012"/>
    <body name="r2" pos="0 0 .1"><joint name="r2" axis="0 -1 0" range="-1.6 1.6"/>
      <geom name="r2" type="capsule" fromto="0 0 .01 0 0 .08" size=".01"/></body></body>
  </worldbody>
  <tendon><fixed name="left"><joint joint="l1" coef="1"/><joint joint="l2" coef="1"/></fixed>
    <fixed name="right"><joint joint="r1" coef="1"/><joint joint="r2" coef="1"/></fixed></tendon>
  <equality><joint joint1="l2" joint2="l1" polycoef="0 1 .2 0 0"/><tendon tendon1="right" tendon2="left"/>
  </equality></mujoco>)";

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_EQUALITY_EQUALITY_MODELS_H_
