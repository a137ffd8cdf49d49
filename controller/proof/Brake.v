(* Inertia: a robot that can brake straight ahead within its limits can do so in each later step.

   [GapLimit::share] allows a velocity if
     closing * step + growth * brake + closing * brake / 2 <= left.
   closing: speed at which the robot approaches the other one; brake: time to brake to rest;
   growth: speed at which the gap shrinks meanwhile; left: the approach that is allowed.

   Straight braking reduces all closing speeds by one factor, so this lemma holds for all
   neighbours at once.

   Not covered: [left] is fixed here, except for the part that a step used. In the controller the
   gap is measured or stored again in each step, and half of it counts. So this file does not prove
   that two robots with inertia never touch; the other files demand that a robot can stand in each
   decision. *)
From Coq Require Import Reals Lra Psatz.
Open Scope R_scope.

Definition allows closing growth brake step left :=
  closing * step + growth * brake + closing * brake / 2 <= left.

(* After a step the robot brakes: the velocity is reduced in the ratio of the braking times. *)
Theorem straight_braking_stays_allowed closing growth brake step left :
  0 <= closing -> 0 <= growth -> 0 < step < brake ->
  allows closing growth brake step left ->
  allows (closing * (brake - step) / brake) growth (brake - step) step
    (left - closing * step - growth * step).
Proof.
  unfold allows. intros Hc Hg [Hs Hb] H.
  assert (E : closing * (brake - step) / brake * step
      + closing * (brake - step) / brake * (brake - step) / 2
    = closing * brake / 2 - closing * step * step / (2 * brake)) by (field; lra).
  assert (0 <= closing * step * step / (2 * brake)).
  { apply Rmult_le_pos; [apply Rmult_le_pos; [nra | lra] |].
    left. apply Rinv_0_lt_compat. lra. }
  lra.
Qed.

(* In the last step it comes to rest, and needs nothing more. *)
Theorem rest_is_allowed closing growth brake step left :
  0 <= closing -> 0 <= growth -> 0 <= brake <= step ->
  allows closing growth brake step left ->
  0 <= left - closing * step - growth * brake.
Proof. unfold allows. intros Hc Hg [Hb Hs] H. assert (0 <= closing * brake) by nra. lra. Qed.
