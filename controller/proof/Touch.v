(* Weaker rules let robots touch: concrete robots that do.

   [greater_share_touches]  Both robots take a share above one half of the gap between them. Both
                            know each other exactly, and touch at the end of one motion.
   [one_half_is_attained]   With one half they end exactly side by side. So the rule permits
                            motion, and its bound is the best one.
   [ends_alone_are_too_weak]
                            Robot [q] passes robot [p] at the least distance and drives away.
                            [p] takes less than half of the gap to the end of [q]'s path, but
                            moves towards its beginning, where [q] may still be. Only the rule
                            [keeps_off] forbids that. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule.
Open Scope R_scope.

(* A robot that moves from [a] to [b] by its only decision, at event [e]; it leaves [a] before
   event [e + 2]. *)
Definition mover (e : nat) (a b : vec) := Course
  (fun t => if t <=? e then a else b)
  (fun t => if t <=? S e then a else b)
  (fun t => t =? e)
  (fun _ => false).

Lemma mover_place e a b t : place (mover e a b) t = if t <=? e then a else b.
Proof. reflexivity. Qed.

Lemma before_le t e : (t <= e)%nat -> (t <=? e) = true.
Proof. apply Nat.leb_le. Qed.

Lemma after_gt t e : (e < t)%nat -> (t <=? e) = false.
Proof. apply Nat.leb_gt. Qed.

Lemma mover_moves e a b : moves (mover e a b).
Proof.
  split.
  - intros t H. cbn [acts place mover] in *. apply Nat.eqb_neq in H.
    destruct (le_lt_dec t e); [rewrite !before_le | rewrite !after_gt]; lia || reflexivity.
  - intros t _ H. discriminate H.
  - intros t. unfold new_path, start. cbn [acts place base mover].
    destruct (lt_eq_lt_dec t e) as [[L | ->] | L].
    + exists 0. split; [unfold part; lra |]. rewrite point_0.
      rewrite (proj2 (Nat.eqb_neq t e)), !before_le by lia. reflexivity.
    + exists 0. split; [unfold part; lra |]. rewrite point_0.
      rewrite Nat.eqb_refl, !before_le by lia. reflexivity.
    + exists 1. split; [unfold part; lra |]. rewrite point_1.
      rewrite !after_gt by lia. reflexivity.
Qed.

Lemma mover_decides e a b t : decides (mover e a b) t -> t = e.
Proof. intros [H _]. apply Nat.eqb_eq, H. Qed.

(* A view that does not depend on the event. *)
Definition constant is_fresh seen begun aside clear gap taken := View (fun _ => is_fresh)
  (fun _ => seen) (fun _ => 0) (fun _ => begun) (fun _ => aside) (fun _ => clear)
  (fun _ => gap) (fun _ => taken) (fun _ => 1%nat) (fun _ => 0%nat).

Lemma narrow_exact u m n : narrow u m (0 / n) = dot m u.
Proof. unfold narrow, Rdiv. ring. Qed.

Lemma norm_sub_self u : norm (sub u u) <= 0.
Proof. rewrite sub_self, norm_zero. lra. Qed.

(** * A share above one half *)

Section Meet.

Variable share : R.
Hypothesis share_range : 0 <= share < 1.

Definition left_one := mover 0 (V 0 0 0) (V share 0 0).
Definition right_one := mover 0 (V 2 0 0) (V (2 - share) 0 0).
Definition of_left := constant true (V 2 0 0) (V 2 0 0) (V 1 0 0) 2 1 share.
Definition of_right := constant true (V (-2) 0 0) (V (-2) 0 0) (V (-1) 0 0) 2 1 share.

Lemma norm_2 : norm (V 2 0 0) = 2.
Proof. apply norm_is; unfold dot; simpl; lra. Qed.

Lemma norm_minus_2 : norm (V (-2) 0 0) = 2.
Proof. apply norm_is; unfold dot; simpl; lra. Qed.

Lemma left_knows : knows left_one right_one of_left.
Proof.
  intros t D. apply mover_decides in D. subst t. simpl. split; [lra |]. split; [discriminate |].
  intros _. replace (offset left_one right_one 0) with (V 2 0 0)
    by (unfold offset, sub; simpl; f_equal; ring).
  split; [apply norm_sub_self |]. intros s Hs. exists s. split; [assumption |].
  apply norm_le; [lra |]. unfold old_path. simpl. unfold point, dot, sub, add, scale; simpl. lra.
Qed.

Lemma right_knows : knows right_one left_one of_right.
Proof.
  intros t D. apply mover_decides in D. subst t. simpl. split; [lra |]. split; [discriminate |].
  intros _. replace (offset right_one left_one 0) with (V (-2) 0 0)
    by (unfold offset, sub; simpl; f_equal; ring).
  split; [apply norm_sub_self |]. intros s Hs. exists s. split; [assumption |].
  apply norm_le; [lra |]. unfold old_path. simpl. unfold point, dot, sub, add, scale; simpl. lra.
Qed.

Lemma left_follows : follows share 1 0 share left_one right_one of_left.
Proof.
  assert (M : motion left_one 0 = V share 0 0)
    by (unfold motion, sub; simpl; f_equal; ring).
  split; [split |]; intros t D; apply mover_decides in D; subst t; simpl.
  - left. unfold ball. simpl. rewrite norm_2. split; [lra | reflexivity].
  - rewrite norm_2. lra.
  - intros _. right. rewrite M. unfold tilt. simpl. rewrite narrow_exact.
    unfold direction, unit. simpl. rewrite norm_2. unfold dot, scale; simpl. lra.
  - left. eapply Rle_trans; [| apply Rmax_l]. lra.
  - intros _. rewrite M. repeat split; [| | | right; right; split].
    + apply norm_le; unfold dot; simpl; lra.
    + unfold dot; simpl; lra.
    + unfold dot; simpl; lra.
    + unfold beyond; simpl; lra.
    + eapply Rle_trans; [| apply Rmax_l]. unfold beyond, dot; simpl. lra.
Qed.

Lemma right_follows : follows share 1 0 share right_one left_one of_right.
Proof.
  assert (M : motion right_one 0 = V (- share) 0 0)
    by (unfold motion, sub; simpl; f_equal; ring).
  split; [split |]; intros t D; apply mover_decides in D; subst t; simpl.
  - left. unfold ball. simpl. rewrite norm_minus_2. split; [lra | reflexivity].
  - rewrite norm_minus_2. lra.
  - intros _. right. rewrite M. unfold tilt. simpl. rewrite narrow_exact.
    unfold direction, unit. simpl. rewrite norm_minus_2. unfold dot, scale; simpl. lra.
  - left. eapply Rle_trans; [| apply Rmax_l]. lra.
  - intros _. rewrite M. repeat split; [| | | right; right; split].
    + apply norm_le; unfold dot; simpl; lra.
    + unfold dot; simpl; lra.
    + unfold dot; simpl; lra.
    + unfold beyond; simpl; lra.
    + eapply Rle_trans; [| apply Rmax_l]. unfold beyond, dot; simpl. lra.
Qed.

Lemma distance_left : dist (place right_one 1) (place left_one 1) = 2 - 2 * share.
Proof. apply norm_is; [lra |]. unfold dot, sub; simpl. ring. Qed.

End Meet.

(* The distance 1 must remain: [keep] is 1, without slack. *)
Theorem greater_share_touches share : 1 / 2 < share < 1 -> exists p q kp kq,
  moves p /\ moves q /\ knows p q kp /\ knows q p kq /\
  follows share 1 0 share p q kp /\ follows share 1 0 share q p kq /\
  dist (place q 0) (place p 0) = 2 /\ dist (place q 1) (place p 1) < 1.
Proof.
  intros H. assert (R : 0 <= share < 1) by lra.
  exists (left_one share), (right_one share), (of_left share), (of_right share).
  split; [apply mover_moves |]. split; [apply mover_moves |].
  split; [apply left_knows |]. split; [apply right_knows |].
  split; [apply left_follows; assumption |]. split; [apply right_follows; assumption |]. split.
  - unfold dist. apply norm_is; unfold dot, sub; simpl; lra.
  - rewrite distance_left by assumption. lra.
Qed.

Theorem one_half_is_attained : exists p q kp kq,
  moves p /\ moves q /\ knows p q kp /\ knows q p kq /\
  follows (1 / 2) 1 0 (1 / 2) p q kp /\ follows (1 / 2) 1 0 (1 / 2) q p kq /\
  dist (place q 0) (place p 0) = 2 /\ dist (place q 1) (place p 1) = 1.
Proof.
  assert (R : 0 <= 1 / 2 < 1) by lra.
  exists (left_one (1 / 2)), (right_one (1 / 2)), (of_left (1 / 2)), (of_right (1 / 2)).
  split; [apply mover_moves |]. split; [apply mover_moves |].
  split; [apply left_knows |]. split; [apply right_knows |].
  split; [apply left_follows; assumption |]. split; [apply right_follows; assumption |]. split.
  - unfold dist. apply norm_is; unfold dot, sub; simpl; lra.
  - rewrite distance_left by assumption. lra.
Qed.

(** * Ends alone *)

(* [q] decides at event 0 and [p] at event 1. The distance 3 must remain. *)
Definition passing := mover 0 (V 0 3 0) (V 4 3 0).
Definition behind := mover 1 (V 0 0 0) (V 0 1 0).
Definition of_passing := constant false (V 0 (-3) 0) zero zero 0 0 0.
Definition of_behind := constant true (V 4 3 0) (V 0 3 0) zero 0 2 1.

Lemma norm_3 : norm (V 0 (-3) 0) = 3.
Proof. apply norm_is; unfold dot; simpl; lra. Qed.

Lemma norm_5 : norm (V 4 3 0) = 5.
Proof. apply norm_is; unfold dot; simpl; lra. Qed.

Lemma passing_knows : knows passing behind of_passing.
Proof.
  intros t D. apply mover_decides in D. subst t. simpl. split; [lra |]. split; [| discriminate].
  intros _ s _. unfold old_path. simpl. rewrite point_same.
  apply norm_le; unfold dot, sub; simpl; lra.
Qed.

Lemma behind_knows : knows behind passing of_behind.
Proof.
  intros t D. apply mover_decides in D. subst t. simpl. split; [lra |]. split; [discriminate |].
  intros _. split; [apply norm_le; unfold offset, dot, sub; simpl; lra |].
  intros s Hs. exists s. split; [assumption |]. unfold old_path. simpl.
  apply norm_le; [lra |]. unfold point, dot, sub, add, scale; simpl. lra.
Qed.

Lemma passing_follows : follows (1 / 2) 3 0 4 passing behind of_passing.
Proof.
  assert (M : motion passing 0 = V 4 0 0) by (unfold motion, sub; simpl; f_equal; ring).
  split; [split |]; intros t D; apply mover_decides in D; subst t; simpl.
  - left. unfold ball. simpl. rewrite norm_3. split; [lra | reflexivity].
  - rewrite norm_3. lra.
  - intros _. right. rewrite M. unfold tilt. simpl. rewrite narrow_exact.
    unfold direction, unit. simpl. rewrite norm_3. unfold dot, scale; simpl. lra.
  - left. eapply Rle_trans; [| apply Rmax_l]. lra.
  - discriminate.
Qed.

Lemma behind_keeps_gap : keeps_gap (1 / 2) 3 0 4 behind passing of_behind.
Proof.
  assert (M : motion behind 1 = V 0 1 0) by (unfold motion, sub; simpl; f_equal; ring).
  split; intros t D; apply mover_decides in D; subst t; simpl.
  - left. unfold ball. simpl. rewrite norm_5. split; [lra | reflexivity].
  - rewrite norm_5. lra.
  - intros _. right. rewrite M. unfold tilt. simpl. rewrite narrow_exact.
    unfold direction, unit. simpl. rewrite norm_5. unfold dot, scale; simpl. lra.
  - left. eapply Rle_trans; [| apply Rmax_l]. lra.
Qed.

(* [old_path q 1 0] is where [q] still is; [new_path p 1 1] is the end of [p]'s motion. *)
Theorem ends_alone_are_too_weak : exists p q kp kq,
  moves p /\ moves q /\ knows p q kp /\ knows q p kq /\
  keeps_gap (1 / 2) 3 0 4 p q kp /\ follows (1 / 2) 3 0 4 q p kq /\
  dist (place q 0) (place p 0) = 3 /\ dist (old_path q 1 0) (new_path p 1 1) = 2.
Proof.
  exists behind, passing, of_behind, of_passing.
  split; [apply mover_moves |]. split; [apply mover_moves |].
  split; [apply behind_knows |]. split; [apply passing_knows |].
  split; [apply behind_keeps_gap |]. split; [apply passing_follows |]. split.
  - unfold dist. apply norm_is; unfold dot, sub; simpl; lra.
  - unfold old_path, new_path, start. simpl. rewrite point_0, point_1.
    unfold dist. apply norm_is; unfold dot, sub; simpl; lra.
Qed.
