(* The proof for one pair of robots: if both follow the rule, their paths never touch.

   All gaps are counted from [floor = keep - 2 slack], the distance that is guaranteed; then the
   accepted excess drops out of the proof. [room] is such a gap.

   The invariant has two parts.

   [apart]   Before each event all points of both paths are at least [floor] apart.
   [banked]  The bound stored by a robot's last decision holds: if the other robot has decided
             [n] times since, the path of the other robot is still at least the room of then,
             halved [n] times, minus the own motion away. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule Course.
Open Scope R_scope.

Section Pair.

Variables share keep slack fastest : R.
Hypothesis half : share = 1 / 2.
Hypothesis slack_nonneg : 0 <= slack.
Hypothesis keep_large : 2 * slack < keep.

Definition floor := keep - 2 * slack.
Definition room k t := gap k t + 2 * slack.

(* The room of a decision, doubled for each spare decision of the other robot. *)
Definition bank k t := 2 ^ spare k t * room k t.

(* The free distance between the ends of the paths. *)
Definition free p q t := dist (place q t) (place p t) - floor.

Definition apart p q t := forall s r, part s -> part r ->
  floor <= dist (old_path q t r) (old_path p t s).

Definition sound p q k t := decides p t -> bank k t <= free p q t
  /\ (fresh k t = false -> forall s, part s ->
        bank k t <= dist (old_path q t s) (place p t) - floor).

Definition banked p q k t := forall b n, last p b t -> decides p b ->
  decisions q t = (decisions q b + n)%nat ->
  let left := bank k b / 2 ^ n - Rmax (taken k b) 0 in
  left <= free p q t
  /\ forall s, part s ->
    ((n = 0%nat -> fresh k b = false) -> left <= dist (old_path q t s) (place p t) - floor)
    /\ (n = 0%nat -> fresh k b = true ->
          left_aside keep slack p k b <= dist (old_path q t s) (place p t) - floor)
    /\ (n = 1%nat -> acts q b = true ->
          room k b / 2 - taken k b <= dist (old_path q t s) (place p t) - floor).

Lemma floor_pos : 0 < floor.
Proof. unfold floor. lra. Qed.

Lemma apart_sym p q t : apart p q t -> apart q p t.
Proof. intros A s r Hs Hr. rewrite dist_sym. apply A; assumption. Qed.

Lemma free_sym p q t : free p q t = free q p t.
Proof. unfold free. rewrite dist_sym. reflexivity. Qed.

Lemma apart_end p q t s : apart p q t -> part s -> floor <= dist (old_path q t s) (place p t).
Proof.
  intros A Hs. rewrite <- (old_end p). apply A; [exact part_1 | assumption].
Qed.

Lemma free_nonneg p q t : apart p q t -> 0 <= free p q t.
Proof.
  intros A. pose proof (apart_end p q t 1 A part_1) as H. rewrite old_end in H.
  unfold free. lra.
Qed.

Section One.

(* One robot, and its view of the other one. *)
Variables p q : course.
Variable k : view.
Hypothesis Mp : moves p.
Hypothesis K : knows p q k.
Hypothesis F : follows share keep slack fastest p q k.

(* [taken] bounds the approach to each place within reach. *)
Lemma counted t o : decides p t -> norm (sub o (seen k t)) <= reach k t -> 0 < norm o ->
  approach o (motion p t) <= taken k t.
Proof.
  intros D Ho Hn. destruct (K t D) as [Hr _].
  destruct (Rle_dec (norm (seen k t)) (reach k t)) as [H | H].
  - destruct (stands _ _ _ _ _ _ _ F t D H) as [E T].
    replace (motion p t) with zero by (unfold motion; rewrite E; symmetry; apply sub_self).
    rewrite approach_zero. assumption.
  - assert (H' : reach k t < norm (seen k t)) by lra.
    assert (P : 0 < norm (seen k t)) by lra.
    assert (O : norm (sub o (scale (norm (seen k t)) (direction k t))) <= reach k t)
      by (unfold direction; rewrite unit_scale by assumption; assumption).
    pose proof (unit_dot (seen k t) P) as U.
    destruct (counts _ _ _ _ _ _ _ F t D H') as [C | C].
    + eapply Rle_trans; [| exact C]. apply approach_le; [assumption |].
      apply cone; [exact U | lra | exact O].
    + eapply Rle_trans; [| exact C]. apply narrow_bound; [assumption |].
      apply tilt_bound; [exact U | lra | exact O].
Qed.

(* Thus a motion takes at most half of the free distance, or all of it if the other pauses. *)
Lemma fair t o f : decides p t -> norm (sub o (seen k t)) <= reach k t -> 0 < norm o ->
  0 <= f -> bank k t <= f ->
  approach o (motion p t) <= f / 2 \/ (paused q t /\ approach o (motion p t) <= f).
Proof.
  intros D Ho Hn Hf Hb. pose proof (counted t o D Ho Hn) as C.
  assert (R : room k t <= f) by (apply power_room with (spare k t); assumption).
  unfold room in R.
  destruct (limits _ _ _ _ _ _ _ F t D) as [L | [[Hm L] | [Hp L]]].
  - left. assert (Rmax (share * gap k t + slack) 0 <= f / 2) by (apply Rmax_lub; subst; lra). lra.
  - left. pose proof (approach_norm o (motion p t) Hn). lra.
  - right. split; [assumption |].
    assert (Rmax (gap k t + slack) 0 <= f) by (apply Rmax_lub; lra). lra.
Qed.

(* The end of the other robot's path is within reach. *)
Lemma end_known t : decides p t -> norm (sub (offset p q t) (seen k t)) <= reach k t.
Proof.
  intros D. destruct (K t D) as [_ [Silent Fresh]]. destruct (fresh k t).
  - apply Fresh; reflexivity.
  - unfold offset. rewrite <- (old_end q). apply Silent; [reflexivity | exact part_1].
Qed.

Lemma fair_end t : apart p q t -> sound p q k t -> acts p t = true ->
  approach (offset p q t) (motion p t) <= free p q t / 2
  \/ (paused q t /\ approach (offset p q t) (motion p t) <= free p q t).
Proof.
  intros A So Ha. pose proof (free_nonneg p q t A) as Fr. pose proof floor_pos.
  destruct (pauses p t) eqn:Hp.
  - left. rewrite (halted p t Mp Ha Hp), approach_zero. lra.
  - assert (D : decides p t) by (split; assumption).
    apply fair; [assumption | apply end_known; assumption | | assumption | apply So; assumption].
    unfold free, dist in Fr. unfold offset. lra.
Qed.

(* A point of the other robot's path, and the point that the own robot takes it for. *)
Lemma path_known t s : decides p t -> fresh k t = true -> part s ->
  exists s', part s' /\ forall u,
    dot u (point (begun k t) (seen k t) s') - norm u * reach k t
      <= dot u (sub (old_path q t s) (place p t))
    /\ dot u (sub (old_path q t s) (place p t))
      <= dot u (point (begun k t) (seen k t) s') + norm u * reach k t.
Proof.
  intros D Hf Hs. destruct (K t D) as [_ [_ Fresh]]. destruct (Fresh Hf) as [_ Path].
  destruct (Path s Hs) as [s' [Hs' E]]. exists s'. split; [assumption |]. intros u.
  set (o := sub (old_path q t s) (place p t)) in *.
  set (e := point (begun k t) (seen k t) s') in *.
  pose proof (cauchy u (sub o e)) as C. pose proof (cauchy u (sub e o)) as C'.
  fold (dist e o) in C'. rewrite dist_sym in C'. unfold dist in C'.
  replace (dot u (sub o e)) with (dot u o - dot u e) in C by (unfold dot, sub; simpl; ring).
  replace (dot u (sub e o)) with (dot u e - dot u o) in C' by (unfold dot, sub; simpl; ring).
  pose proof (norm_nonneg u). nra.
Qed.

Lemma dot_point u a b s : dot u (point a b s) = (1 - s) * dot u a + s * dot u b.
Proof. unfold point, dot, add, sub, scale; simpl; ring. Qed.

(* The distance that the plane leaves is free. *)
Lemma aside_left t s r : decides p t -> fresh k t = true -> part s ->
  clear k t - reach k t - r * dot (aside k t) (motion p t)
    <= dist (old_path q t s) (add (place p t) (scale r (motion p t))).
Proof.
  intros D Hf Hs. destruct (K t D) as [Hreach _].
  destruct (path_known t s D Hf Hs) as [s' [[S0 S1] E]].
  destruct (E (aside k t)) as [E1 _]. rewrite dot_point in E1.
  destruct (keeps_off _ _ _ _ _ _ _ F t D Hf) as [U [B [G _]]].
  set (o := sub (old_path q t s) (place p t)) in *.
  replace (dist (old_path q t s) (add (place p t) (scale r (motion p t))))
    with (norm (sub o (scale r (motion p t)))) by (unfold o, dist; f_equal; same).
  replace (r * dot (aside k t) (motion p t)) with (dot (aside k t) (scale r (motion p t)))
    by (unfold dot, scale; simpl; ring).
  apply beside; [assumption |]. pose proof (norm_nonneg (aside k t)). nra.
Qed.

(* A robot that retreats comes no nearer to any point of the path. *)
Lemma retreats_from t s : decides p t -> fresh k t = true -> part s -> retreats p k t ->
  0 < dist (old_path q t s) (place p t) ->
  approach (sub (old_path q t s) (place p t)) (motion p t) <= 0.
Proof.
  intros D Hf Hs [Rb Rs] Hw. destruct (path_known t s D Hf Hs) as [s' [[S0 S1] E]].
  destruct (E (motion p t)) as [_ E1]. rewrite dot_point in E1.
  assert (B : dot (motion p t) (begun k t) + reach k t * norm (motion p t) <= 0)
    by (rewrite dot_sym; exact Rb).
  assert (N : dot (motion p t) (seen k t) + reach k t * norm (motion p t) <= 0)
    by (rewrite dot_sym; exact Rs).
  apply approach_le; [assumption |]. rewrite Rmult_0_r, dot_sym. nra.
Qed.

(* The new path of a robot keeps off the old path of the other one. *)
Lemma new_old t s r : apart p q t -> sound p q k t -> acts p t = true -> part s -> part r ->
  floor <= dist (old_path q t s) (add (place p t) (scale r (motion p t))).
Proof.
  intros A So Ha Hs Hr. pose proof (apart_end p q t s A Hs) as H. pose proof floor_pos as Fl.
  assert (P : 0 < dist (old_path q t s) (place p t)) by lra.
  assert (Still : motion p t = zero ->
    floor <= dist (old_path q t s) (add (place p t) (scale r (motion p t)))).
  { intros ->. rewrite add_zero. assumption. }
  destruct (pauses p t) eqn:Hp; [apply Still, halted; assumption |].
  assert (D : decides p t) by (split; assumption).
  destruct (fresh k t) eqn:Hf.
  - destruct (keeps_off _ _ _ _ _ _ _ F t D Hf) as [_ [_ [_ [E | [E | [L0 L]]]]]].
    + apply Still. unfold motion. rewrite E. apply sub_self.
    + pose proof (retreats_from t s D Hf Hs E P) as G.
      pose proof (approach_one (place p t) (old_path q t s) (motion p t) r 0 P Hr G). lra.
    + pose proof (aside_left t s r D Hf Hs) as B. unfold beyond in *. destruct Hr as [R0 R1].
      assert (Rmax (clear k t - reach k t - keep + slack) 0
        <= clear k t - reach k t - floor) by (apply Rmax_lub; unfold floor; lra).
      unfold floor in *. nra.
  - set (f := dist (old_path q t s) (place p t) - floor).
    assert (G : approach (sub (old_path q t s) (place p t)) (motion p t) <= f).
    { destruct (K t D) as [_ [Silent _]].
      destruct (fair t (sub (old_path q t s) (place p t)) f D) as [G | [_ G]]; unfold f in *;
        try lra; [apply Silent; assumption | exact P | apply So; assumption]. }
    pose proof (approach_one (place p t) (old_path q t s) (motion p t) r f P Hr G) as G'.
    unfold f in *. lra.
Qed.

(* Both decide: their new paths keep off each other. [a], [b]: their approaches. *)
Lemma both_fair a b f : 0 <= f -> (a <= f / 2 \/ (b = 0 /\ a <= f)) ->
  (b <= f / 2 \/ (a = 0 /\ b <= f)) ->
  forall s r, part s -> part r -> s * a + r * b <= f.
Proof. intros Hf Ha Hb s r [S0 S1] [R0 R1]. nra. Qed.

(* The bound of this decision is right, if all earlier ones are. *)
Lemma bounds_sound t : apart p q t -> banked p q k t -> sound p q k t.
Proof.
  intros A B D. pose proof (free_nonneg p q t A) as Fr.
  assert (Path : forall s, part s -> 0 <= dist (old_path q t s) (place p t) - floor)
    by (intros s Hs; pose proof (apart_end p q t s A Hs); lra).
  destruct (K t D) as [_ [Silent _]].
  destruct (bounds _ _ _ _ _ _ _ F t D) as [[G E] | [G | [b [La [Db [Af G]]]]]].
  - (* The ball. *)
    unfold bank, room, ball in *. rewrite E. simpl. rewrite Rmult_1_l. split.
    + pose proof (end_known t D) as O. pose proof (norm_dist (seen k t) (offset p q t)) as T.
      rewrite dist_sym in T. unfold dist in T. unfold free, floor, dist. unfold offset in *. lra.
    + intros Hf s Hs. specialize (Silent Hf s Hs).
      pose proof (norm_dist (seen k t) (sub (old_path q t s) (place p t))) as T.
      rewrite dist_sym in T. unfold dist in T. unfold floor, dist. lra.
  - (* Nothing. *)
    assert (bank k t <= 0).
    { unfold bank, room. pose proof (power_pos (spare k t)). nra. }
    split; [lra |]. intros _ s Hs. specialize (Path s Hs). lra.
  - (* A stored bound. *)
    destruct (decisions_split q b t ltac:(apply La)) as [n Hn].
    destruct (B b n La Db Hn) as [Bf Bp]. clear B.
    assert (Neg : bank k t <= 0 \/ 0 < room k t).
    { destruct (Rle_dec (room k t) 0); [left | right; lra]. unfold bank.
      pose proof (power_pos (spare k t)). nra. }
    pose proof (Rmax_r (taken k b) 0) as T0. pose proof (Rmax_l (taken k b) 0) as T1.
    destruct Neg as [Neg | Pos].
    { split; [lra |]. intros _ s Hs. specialize (Path s Hs). lra. }
    destruct G as [[G E] | [G [E [Q N]]]].
    + assert (Le : bank k t <= bank k b / 2 ^ n - Rmax (taken k b) 0).
      { unfold bank, room, stored in *. rewrite half in G.
        destruct (Rle_dec (gap k b + 2 * slack) 0) as [Z | Z].
        - exfalso. assert (0 < (1 - 1 / 2) ^ halved k t) by (apply pow_lt; lra). nra.
        - eapply Rle_trans;
            [| apply (power_halved (spare k b) (spare k t) (halved k t) n); lra || lia].
          apply Rmult_le_compat_l; [left; apply power_pos | lra]. }
      split; [lra |]. intros _ s Hs. destruct (Bp s Hs) as [B1 [B2 _]].
      destruct n as [| n].
      * destruct (fresh k b) eqn:Hfb.
        -- rewrite Nat.add_0_r in Hn. destruct (Af eq_refl Hn) as [O | O].
           ++ unfold old_path. rewrite O, point_same. unfold free in Bf. lra.
           ++ specialize (B2 eq_refl eq_refl). unfold bank, room. lra.
        -- specialize (B1 (fun _ => eq_refl)). lra.
      * assert (B3 : S n = 0%nat -> fresh k b = false) by discriminate. specialize (B1 B3). lra.
    + assert (n = 1%nat) by lia. subst n. unfold stored_together, bank, room in *.
      rewrite E. simpl. rewrite half in G.
      assert (Half : forall s, part s ->
        1 * (gap k t + 2 * slack) <= dist (old_path q t s) (place p t) - floor).
      { intros s Hs. destruct (Bp s Hs) as [_ [_ B3]]. specialize (B3 eq_refl Q). lra. }
      split; [| intros _; exact Half].
      specialize (Half 1 part_1). rewrite old_end in Half. exact Half.
Qed.

End One.

Section Both.

Variables p q : course.
Variables kp kq : view.
Hypothesis Mp : moves p.
Hypothesis Mq : moves q.
Hypothesis Kp : knows p q kp.
Hypothesis Kq : knows q p kq.
Hypothesis Fp : follows share keep slack fastest p q kp.
Hypothesis Fq : follows share keep slack fastest q p kq.

(* The approaches of both motions along the line between the ends of the old paths. *)
Definition own t := approach (offset p q t) (motion p t).
Definition other t := approach (offset q p t) (motion q t).

Lemma both_move t s r : apart p q t ->
  free p q t - s * own t - r * other t
    <= dist (add (place q t) (scale r (motion q t))) (add (place p t) (scale s (motion p t)))
       - floor.
Proof.
  intros A. pose proof (free_nonneg p q t A) as Fr. pose proof floor_pos.
  assert (P : 0 < dist (place q t) (place p t)) by (unfold free in Fr; lra).
  pose proof (approach_both (place p t) (place q t) (motion p t) (motion q t) s r P) as B.
  unfold free, own, other, offset. lra.
Qed.

(* The new paths of two robots that both decide keep off each other. *)
Lemma new_new t s r : apart p q t -> sound p q kp t -> sound q p kq t ->
  acts p t = true -> acts q t = true -> part s -> part r ->
  floor <= dist (add (place q t) (scale r (motion q t))) (add (place p t) (scale s (motion p t))).
Proof.
  intros A Sp Sq Ap Aq Hs Hr. pose proof (both_move t s r A) as B.
  pose proof (free_nonneg p q t A) as Fr.
  assert (Ho : own t <= free p q t / 2 \/ (other t = 0 /\ own t <= free p q t)).
  { destruct (fair_end p q kp Mp Kp Fp t A Sp Ap) as [G | [G0 G]]; [left; exact G | right].
    split; [| exact G]. unfold other. rewrite (paused_halts q t Mq G0 Aq). apply approach_zero. }
  assert (Ht : other t <= free p q t / 2 \/ (own t = 0 /\ other t <= free p q t)).
  { pose proof (fair_end q p kq Mq Kq Fq t (apart_sym p q t A) Sq Aq) as G.
    rewrite (free_sym q p) in G. destruct G as [G | [G0 G]]; [left; exact G | right].
    split; [| exact G]. unfold own. rewrite (paused_halts p t Mp G0 Ap). apply approach_zero. }
  pose proof (both_fair (own t) (other t) (free p q t) Fr Ho Ht s r Hs Hr). lra.
Qed.

(* The other robot takes at most half, since the last decision of [p] is not a pause. *)
Lemma other_half t b : apart p q t -> sound q p kq t -> acts q t = true ->
  decides p b -> (b <= t)%nat -> (forall u, (b < u <= t)%nat -> acts p u = false) ->
  other t <= free p q t / 2.
Proof.
  intros A Sq Aq Db Hb N.
  pose proof (fair_end q p kq Mq Kq Fq t (apart_sym p q t A) Sq Aq) as G.
  rewrite (free_sym q p) in G. destruct G as [G | [G _]]; [exact G |].
  exfalso. exact (not_paused p b t Db Hb N G).
Qed.

(* The decision of event t stores a right bound: the other robot decides at event t, too. *)
Lemma banked_together t : apart p q t -> sound p q kp t -> sound q p kq t ->
  decides p t -> acts q t = true -> forall s, part s ->
  bank kp t / 2 - Rmax (taken kp t) 0 <= dist (old_path q (S t) s) (place p (S t)) - floor
  /\ room kp t / 2 - taken kp t <= dist (old_path q (S t) s) (place p (S t)) - floor.
Proof.
  intros A Sp Sq D Aq s Hs. destruct (old_after q t s Mq Hs) as [r [[R0 R1] E]].
  rewrite E, (moved q t r Mq Aq), (end_moved p t).
  pose proof (both_move t 1 r A) as B. pose proof (free_nonneg p q t A) as Fr.
  assert (H : other t <= free p q t / 2)
    by (apply (other_half t t); auto; intros; lia).
  assert (C : own t <= taken kp t).
  { apply (counted p q kp Kp Fp t (offset p q t) D).
    - apply (end_known p q kp Kp t D).
    - pose proof floor_pos. unfold free, dist in Fr. unfold offset. lra. }
  destruct (Sp D) as [Bk _].
  pose proof (power_room (spare kp t) (room kp t) (free p q t) Fr Bk).
  pose proof (Rmax_l (taken kp t) 0). split; nra.
Qed.

(* Only this robot decides at event t. *)
Lemma banked_alone t : apart p q t -> sound p q kp t -> decides p t -> acts q t = false ->
  bank kp t - Rmax (taken kp t) 0 <= free p q (S t)
  /\ forall s, part s ->
    (fresh kp t = false ->
      bank kp t - Rmax (taken kp t) 0 <= dist (old_path q (S t) s) (place p (S t)) - floor)
    /\ (fresh kp t = true ->
      left_aside keep slack p kp t <= dist (old_path q (S t) s) (place p (S t)) - floor).
Proof.
  intros A Sp D Aq. destruct (Sp D) as [Bk Bs]. pose proof floor_pos as Fl.
  pose proof (Rmax_l (taken kp t) 0) as T0. pose proof (Rmax_r (taken kp t) 0) as T1.
  assert (One : forall o, 0 < dist o (place p t) ->
    norm (sub (sub o (place p t)) (seen kp t)) <= reach kp t ->
    dist o (place p t) - Rmax (taken kp t) 0 <= dist o (place p (S t))).
  { intros o Ho Hr. rewrite (end_moved p t).
    apply approach_one; [assumption | exact part_1 | | assumption].
    pose proof (counted p q kp Kp Fp t _ D Hr Ho). lra. }
  split.
  - unfold free. rewrite (rests q Mq t Aq).
    pose proof (free_nonneg p q t A) as Fr. unfold free in *.
    assert (P : 0 < dist (place q t) (place p t)) by lra.
    pose proof (One (place q t) P (end_known p q kp Kp t D)). lra.
  - intros s Hs. destruct (old_after q t s Mq Hs) as [r [Hr E]].
    rewrite E, (not_moved q t r Mq Aq). split; intros Hf.
    + pose proof (apart_end p q t r A Hr). specialize (Bs Hf r Hr).
      destruct (Kp t D) as [_ [Silent _]].
      assert (P : 0 < dist (old_path q t r) (place p t)) by lra.
      pose proof (One (old_path q t r) P (Silent Hf r Hr)). lra.
    + pose proof (aside_left p q kp Kp Fp t r 1 D Hf Hr) as B. rewrite <- end_moved in B.
      unfold left_aside, beyond, floor. lra.
Qed.

(* An older bound, if the other robot decides at event t. *)
Lemma banked_other t b : apart p q t -> sound q p kq t -> last p b (S t) -> (b < t)%nat ->
  decides p b -> acts q t = true -> forall s, part s ->
  free p q t / 2 <= dist (old_path q (S t) s) (place p (S t)) - floor.
Proof.
  intros A Sq [_ N] Hb Db Aq s Hs. destruct (old_after q t s Mq Hs) as [r [[R0 R1] E]].
  rewrite E, (moved q t r Mq Aq).
  rewrite (rests p Mp t) by (apply N; lia).
  pose proof (both_move t 0 r A) as B. pose proof (free_nonneg p q t A) as Fr.
  assert (H : other t <= free p q t / 2).
  { apply (other_half t b); auto; [lia |]. intros u Hu. apply N. lia. }
  replace (add (place p t) (scale 0 (motion p t))) with (place p t) in B
    by (destruct (place p t); same).
  nra.
Qed.

Lemma banked_step t : apart p q t -> sound p q kp t -> sound q p kq t ->
  banked p q kp t -> banked p q kp (S t).
Proof.
  intros A Sp Sq B b n La Db Hn. cbv zeta. destruct La as [Hb N].
  pose proof (Rmax_r (taken kp b) 0) as T0. simpl in Hn.
  destruct (Nat.eq_dec b t) as [-> | Ne].
  - destruct (acts q t) eqn:Aq.
    + assert (n = 1%nat) by lia. subst n.
      pose proof (banked_together t A Sp Sq Db Aq) as G. simpl (2 ^ 1). rewrite Rmult_1_r.
      split.
      * destruct (G 1 part_1) as [G1 _]. rewrite old_end in G1. exact G1.
      * intros s Hs. destruct (G s Hs) as [G1 G2]. repeat split; intros; auto; discriminate.
    + assert (n = 0%nat) by lia. subst n.
      destruct (banked_alone t A Sp Db Aq) as [G1 G2]. simpl (2 ^ 0). unfold Rdiv.
      rewrite Rinv_1, Rmult_1_r. split; [exact G1 |].
      intros s Hs. destruct (G2 s Hs) as [G3 G4]. repeat split; intros; auto; discriminate.
  - assert (Hbt : (b < t)%nat) by lia.
    assert (La : last p b t) by (split; [assumption | intros u Hu; apply N; lia]).
    destruct (acts q t) eqn:Aq.
    + destruct n as [| n].
      { pose proof (decisions_le q b t). lia. }
      assert (Hn' : decisions q t = (decisions q b + n)%nat) by lia.
      destruct (B b n La Db Hn') as [Bf _].
      assert (L : bank kp b / 2 ^ S n - Rmax (taken kp b) 0 <= free p q t / 2)
        by (rewrite <- halves; lra).
      pose proof (banked_other t b A Sq (conj Hb N) Hbt Db Aq) as G. split.
      * specialize (G 1 part_1). rewrite old_end in G. unfold free in *. lra.
      * intros s Hs. specialize (G s Hs). repeat split; intros; try discriminate; try lra.
        (* The other robot decided at event b and now: that is more than once. *)
        pose proof (decisions_le q (S b) t Hbt) as Two. simpl in Two.
        rewrite H0 in Two. lia.
    + destruct (B b n La Db Hn) as [Bf Bp]. unfold free.
      rewrite (rests q Mq t Aq), (rests p Mp t) by (apply N; lia).
      split; [exact Bf |]. intros s Hs. destruct (old_after q t s Mq Hs) as [r [Hr E]].
      rewrite E, (not_moved q t r Mq Aq). apply Bp. assumption.
Qed.

(* The paths before and after an event. *)
Definition side := bool.
Definition path_at (c : course) t (after : side) s :=
  if after then new_path c t s else old_path c t s.

Lemma new_or_old c t s : moves c -> new_path c t s = old_path c t s
  \/ (acts c t = true /\ new_path c t s = add (place c t) (scale s (motion c t))).
Proof.
  intros M. destruct (acts c t) eqn:E.
  - right. split; [reflexivity | apply moved; assumption].
  - left. apply not_moved; assumption.
Qed.

Lemma paths_apart t : apart p q t -> sound p q kp t -> sound q p kq t ->
  forall i j s r, part s -> part r -> floor <= dist (path_at q t j r) (path_at p t i s).
Proof.
  intros A Sp Sq i j s r Hs Hr.
  assert (Old : floor <= dist (old_path q t r) (old_path p t s)) by (apply A; assumption).
  assert (P : acts p t = true -> new_path p t s = add (place p t) (scale s (motion p t)) ->
    floor <= dist (old_path q t r) (new_path p t s)).
  { intros Ap ->. apply (new_old p q kp Mp Kp Fp t r s A Sp Ap Hr Hs). }
  assert (Q : acts q t = true -> new_path q t r = add (place q t) (scale r (motion q t)) ->
    floor <= dist (new_path q t r) (old_path p t s)).
  { intros Aq ->. rewrite dist_sym.
    apply (new_old q p kq Mq Kq Fq t s r (apart_sym p q t A) Sq Aq Hs Hr). }
  destruct (new_or_old p t s Mp) as [Ep | [Ap Ep]];
    destruct (new_or_old q t r Mq) as [Eq | [Aq Eq]];
    destruct i, j; unfold path_at; rewrite ?Ep, ?Eq in *; auto.
  apply new_new; assumption.
Qed.

End Both.

(* The theorem for one pair. *)
Section Invariance.

Variables p q : course.
Variables kp kq : view.
Hypothesis Mp : moves p.
Hypothesis Mq : moves q.
Hypothesis Kp : knows p q kp.
Hypothesis Kq : knows q p kq.
Hypothesis Fp : follows share keep slack fastest p q kp.
Hypothesis Fq : follows share keep slack fastest q p kq.
Hypothesis first : apart p q 0.

Definition invariant t := apart p q t /\ banked p q kp t /\ banked q p kq t.

Lemma invariant_holds t : invariant t.
Proof.
  induction t as [| t [A [Bp Bq]]].
  - split; [assumption |]. split; intros b n [Hb _]; lia.
  - pose proof (bounds_sound p q kp Kp Fp t A Bp) as Sp.
    pose proof (bounds_sound q p kq Kq Fq t (apart_sym p q t A) Bq) as Sq.
    split; [| split].
    + intros s r Hs Hr. destruct (old_after p t s Mp Hs) as [s' [Hs' ->]].
      destruct (old_after q t r Mq Hr) as [r' [Hr' ->]].
      apply (paths_apart p q kp kq Mp Mq Kp Kq Fp Fq t A Sp Sq true true s' r'); assumption.
    + apply (banked_step p q kp kq); assumption.
    + apply (banked_step q p kq kp); auto. apply apart_sym; assumption.
Qed.

(* Any point of either path before or after event t, from any point of either path of the other
   robot. *)
Theorem paths_never_meet t i j s r : part s -> part r ->
  floor <= dist (path_at q t j r) (path_at p t i s).
Proof.
  intros Hs Hr. destruct (invariant_holds t) as [A [Bp Bq]].
  apply (paths_apart p q kp kq); auto.
  - apply (bounds_sound p q kp Kp Fp t A Bp).
  - apply (bounds_sound q p kq Kq Fq t (apart_sym p q t A) Bq).
Qed.

End Invariance.
End Pair.
