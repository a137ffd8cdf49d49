(* Facts about halving and about courses that the invariant needs.

   [power_halved]  A bound that is halved [j] times allows for [n] decisions of the other robot, if
                   [spare] decisions were allowed for in addition.
   [old_after]     A path before an event is the rest of the path after the event before.
   [not_paused]    A robot whose last decision is not a pause is not paused. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule.
Open Scope R_scope.

(** * Numbers *)

Lemma power_pos n : 0 < 2 ^ n.
Proof. apply pow_lt. lra. Qed.

Lemma power_ge_1 n : 1 <= 2 ^ n.
Proof. apply pow_R1_Rle. lra. Qed.

Lemma half_power n : (1 - 1 / 2) ^ n * 2 ^ n = 1.
Proof. rewrite <- Rpow_mult_distr. replace ((1 - 1 / 2) * 2) with 1 by lra. apply pow1. Qed.

(* A multiple of a number is not positive, or larger than the number. *)
Lemma power_room n r f : 0 <= f -> 2 ^ n * r <= f -> r <= f.
Proof. intros Hf H. pose proof (power_ge_1 n). destruct (Rle_dec r 0); nra. Qed.

Lemma halves a n : a / 2 ^ n / 2 = a / 2 ^ S n.
Proof. pose proof (power_pos n). simpl. field. lra. Qed.

(* A bound [g] halved [j] times allows for [n] decisions of the other robot, if [e] was spare
   before, and [e'] is spare afterwards. *)
Lemma power_halved e e' j n g a : (e' + n <= e + j)%nat -> 0 <= a -> 0 <= g ->
  2 ^ e' * ((1 - 1 / 2) ^ j * g - a) <= 2 ^ e * g / 2 ^ n - a.
Proof.
  intros He Ha Hg. pose proof (half_power j) as J. pose proof (power_ge_1 e').
  pose proof (power_pos n) as N. pose proof (power_pos j) as Pj.
  assert (E : 2 ^ e' * ((1 - 1 / 2) ^ j * g) <= 2 ^ e * g / 2 ^ n).
  { apply Rmult_le_reg_r with (2 ^ n * 2 ^ j); [nra |].
    replace (2 ^ e' * ((1 - 1 / 2) ^ j * g) * (2 ^ n * 2 ^ j))
      with (2 ^ e' * 2 ^ n * ((1 - 1 / 2) ^ j * 2 ^ j) * g) by ring.
    replace (2 ^ e * g / 2 ^ n * (2 ^ n * 2 ^ j)) with (2 ^ e * 2 ^ j * g) by (field; lra).
    rewrite J, <- !pow_add, Rmult_1_r. apply Rmult_le_compat_r; [assumption |].
    apply Rle_pow; [lra | lia]. }
  nra.
Qed.

(** * Courses *)

Lemma moved c t s : moves c -> acts c t = true ->
  new_path c t s = add (place c t) (scale s (motion c t)).
Proof. intros _ A. unfold new_path, start. rewrite A. reflexivity. Qed.

Lemma not_moved c t s : moves c -> acts c t = false -> new_path c t s = old_path c t s.
Proof.
  intros M A. unfold new_path, old_path, start. rewrite A, (rests c M t A). reflexivity.
Qed.

Lemma old_after c t s : moves c -> part s ->
  exists s', part s' /\ old_path c (S t) s = new_path c t s'.
Proof.
  intros M Hs. destruct (advances c M t) as [r [Hr E]]. unfold old_path. rewrite E.
  apply point_rest; assumption.
Qed.

Lemma old_end c t : old_path c t 1 = place c t.
Proof. apply point_1. Qed.

Lemma end_moved c t : place c (S t) = add (place c t) (scale 1 (motion c t)).
Proof. unfold motion. symmetry. apply point_1. Qed.

Lemma halted c t : moves c -> acts c t = true -> pauses c t = true -> motion c t = zero.
Proof. intros M A H. unfold motion. rewrite (halts c M t A H). apply sub_self. Qed.

Lemma part_1 : part 1.
Proof. unfold part; lra. Qed.

(* A paused robot that decides, pauses. *)
Lemma paused_halts c t : moves c -> paused c t -> acts c t = true -> motion c t = zero.
Proof.
  intros M [b [Hb [A [H N]]]] Ht. destruct (Nat.eq_dec b t) as [-> | D].
  - apply halted; assumption.
  - rewrite (N t) in Ht by lia. discriminate.
Qed.

(* A robot whose last decision is not a pause is not paused. *)
Lemma not_paused c b t : decides c b -> (b <= t)%nat ->
  (forall u, (b < u <= t)%nat -> acts c u = false) -> ~ paused c t.
Proof.
  intros [A H] Hb N [b' [Hb' [A' [H' N']]]].
  destruct (lt_eq_lt_dec b b') as [[L | ->] | L].
  - rewrite (N b') in A' by lia. discriminate.
  - congruence.
  - rewrite (N' b) in A by lia. discriminate.
Qed.

Lemma decisions_le c b t : (b <= t)%nat -> (decisions c b <= decisions c t)%nat.
Proof. induction 1; [lia |]. simpl. destruct (acts c m); lia. Qed.

Lemma decisions_split c b t : (b < t)%nat ->
  exists n, decisions c t = (decisions c b + n)%nat.
Proof.
  intros H. exists (decisions c t - decisions c b)%nat.
  pose proof (decisions_le c b t). lia.
Qed.
