(* From beacons to knowledge: why the ball of a silent robot holds all of its path.

   A beacon names the place of a decision and its velocity, thus both ends of a path, each with
   an error of at most [error] (rounding of positions, velocity, radius and of the own place).

   [fresh_knowledge]   The last decision of the other robot is known. Then all of its path is
                       within [error] of the path that was received.
   [silent_knowledge]  The other robot may have decided since, at most [count] times, and [count]
                       is at least 1. Then all of its path is within [fastest * count + error] of
                       the end that was received: whether or not it has decided.

   Losses, delays and the order of packets do not matter: each packet may be the last one that is
   used. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule Course.
Open Scope R_scope.

(* Where the path before event t began. *)
Fixpoint origin (c : course) (t : nat) : vec :=
  match t with
  | O => base c O
  | S t => if acts c t then place c t else origin c t
  end.

Section Hearing.

(* The longest motion of a decision, and the error of an offset. *)
Variables fastest error : R.
Hypothesis fastest_nonneg : 0 <= fastest.
Hypothesis error_nonneg : 0 <= error.

(* No motion is longer than [fastest]; robots stand before the first event. *)
Definition slow c := base c O = place c O /\ forall t, norm (motion c t) <= fastest.

(* A robot is on the path that it has begun. *)
Lemma on_path c t : moves c -> exists s, part s /\ base c t = point (origin c t) (place c t) s.
Proof.
  intros M. induction t as [| t [s [Hs E]]].
  - exists 0. split; [unfold part; lra | simpl; symmetry; apply point_0].
  - destruct (advances c M t) as [r [Hr B]]. rewrite B. unfold new_path, start. simpl.
    destruct (acts c t) eqn:A; [exists r; split; [exact Hr | reflexivity] |].
    rewrite (rests c M t A), E. apply point_rest; assumption.
Qed.

Lemma old_on_path c t s : moves c -> part s ->
  exists s', part s' /\ old_path c t s = point (origin c t) (place c t) s'.
Proof.
  intros M Hs. destruct (on_path c t M) as [r [Hr E]]. unfold old_path. rewrite E.
  apply point_rest; assumption.
Qed.

(* Two paths whose ends are near each other are near each other. *)
Lemma paths_near a b c d s e : part s -> dist a c <= e -> dist b d <= e ->
  dist (point a b s) (point c d s) <= e.
Proof.
  intros [S0 S1] A B. unfold dist in *.
  replace (sub (point a b s) (point c d s))
    with (add (scale (1 - s) (sub a c)) (scale s (sub b d))) by same.
  eapply Rle_trans; [apply triangle |]. rewrite !norm_scale by lra. nra.
Qed.

Theorem fresh_knowledge p q t begun seen : moves q ->
  norm (sub (sub (origin q t) (place p t)) begun) <= error ->
  norm (sub (offset p q t) seen) <= error ->
  forall s, part s -> exists s', part s'
    /\ norm (sub (sub (old_path q t s) (place p t)) (point begun seen s')) <= error.
Proof.
  intros M B E s Hs. destruct (old_on_path q t s M Hs) as [s' [Hs' ->]].
  exists s'. split; [assumption |].
  replace (sub (point (origin q t) (place q t) s') (place p t))
    with (point (sub (origin q t) (place p t)) (offset p q t) s') by (unfold offset; same).
  apply paths_near; assumption.
Qed.

Lemma path_short c t : moves c -> slow c -> dist (origin c t) (place c t) <= fastest.
Proof.
  intros M [B L]. induction t as [| t IH]; simpl.
  - rewrite B, dist_self. assumption.
  - destruct (acts c t) eqn:A.
    + rewrite dist_sym. apply L.
    + rewrite (rests c M t A). assumption.
Qed.

(* The end of a path after [n] more decisions. *)
Lemma way c h d n : moves c -> slow c -> decisions c (h + d) = (decisions c h + n)%nat ->
  dist (place c (h + d)) (place c h) <= fastest * INR n.
Proof.
  intros M [_ L]. revert n. induction d as [| d IH]; intros n Hn.
  - rewrite Nat.add_0_r in *. replace n with 0%nat by lia. rewrite dist_self. simpl. lra.
  - rewrite Nat.add_succ_r in *. simpl in Hn.
    pose proof (dist_triangle (place c (S (h + d))) (place c (h + d)) (place c h)) as T.
    destruct (acts c (h + d)) eqn:A.
    + destruct n as [| n].
      { pose proof (decisions_le c h (h + d)). lia. }
      specialize (IH n ltac:(lia)). specialize (L (h + d)%nat). unfold motion in L.
      rewrite S_INR. unfold dist in *. lra.
    + rewrite (rests c M (h + d) A). apply IH. exact Hn.
Qed.

(* All of the path, with at least one decision counted. *)
Lemma path_way c h d n count : moves c -> slow c ->
  decisions c (h + d) = (decisions c h + n)%nat -> (n <= count)%nat -> (1 <= count)%nat ->
  forall s, part s -> dist (old_path c (h + d) s) (place c h) <= fastest * INR count.
Proof.
  intros M L Hn Hc H1 s Hs. destruct (old_on_path c (h + d) s M Hs) as [s' [Hs' ->]].
  revert n Hn Hc. induction d as [| d IH]; intros n Hn Hc.
  - rewrite Nat.add_0_r in *.
    pose proof (paths_near (origin c h) (place c h) (place c h) (place c h) s' fastest Hs'
      (path_short c h M L)) as P.
    rewrite dist_self, point_same in P. specialize (P fastest_nonneg).
    assert (1 <= INR count) by (apply (le_INR 1); assumption). nra.
  - rewrite Nat.add_succ_r in *. simpl in Hn. simpl (origin c (S (h + d))).
    destruct (acts c (h + d)) eqn:A.
    + (* The last of [n] decisions began where the one before ended. *)
      destruct n as [| n].
      { pose proof (decisions_le c h (h + d)). lia. }
      pose proof (way c h d n M L ltac:(lia)) as W.
      pose proof (point_dist (place c (h + d)) (place c (S (h + d))) s' Hs') as P.
      pose proof (dist_triangle (point (place c (h + d)) (place c (S (h + d))) s')
        (place c (h + d)) (place c h)) as T.
      destruct L as [_ L]. specialize (L (h + d)%nat). unfold motion in L.
      assert (I : INR (S n) <= INR count) by (apply le_INR; assumption).
      rewrite S_INR in I. unfold dist in *. nra.
    + rewrite (rests c M (h + d) A). apply (IH n Hn Hc).
Qed.

(* The beacon of event [h] is the last one that was used. *)
Theorem silent_knowledge p q t h n count seen : moves q -> slow q -> (h <= t)%nat ->
  decisions q t = (decisions q h + n)%nat -> (n <= count)%nat -> (1 <= count)%nat ->
  norm (sub (sub (place q h) (place p t)) seen) <= error ->
  forall s, part s ->
    norm (sub (sub (old_path q t s) (place p t)) seen) <= fastest * INR count + error.
Proof.
  intros M L Ht Hn Hc H1 E s Hs. replace t with (h + (t - h))%nat in Hn |- * by lia.
  pose proof (path_way q h (t - h) n count M L Hn Hc H1 s Hs) as W.
  replace (h + (t - h))%nat with t in * by lia.
  pose proof (dist_triangle (sub (old_path q t s) (place p t))
    (sub (place q h) (place p t)) seen) as T.
  unfold dist in *.
  replace (sub (sub (old_path q t s) (place p t)) (sub (place q h) (place p t)))
    with (sub (old_path q t s) (place q h)) in T by same.
  lra.
Qed.

(* The beacons that robot [p] uses; [heard t] is the event of the last one. *)
Definition hears p q k (heard count : nat -> nat) := forall t, decides p t ->
  (fresh k t = true -> reach k t = error
     /\ norm (sub (sub (origin q t) (place p t)) (begun k t)) <= error
     /\ norm (sub (offset p q t) (seen k t)) <= error)
  /\ (fresh k t = false -> reach k t = fastest * INR (count t) + error
     /\ (heard t <= t)%nat /\ (1 <= count t)%nat
     /\ (decisions q t <= decisions q (heard t) + count t)%nat
     /\ norm (sub (sub (place q (heard t)) (place p t)) (seen k t)) <= error).

Theorem hearing_is_knowing p q k heard count : moves q -> slow q ->
  hears p q k heard count -> knows p q k.
Proof.
  intros M L H t D. destruct (H t D) as [F S]. destruct (fresh k t) eqn:E.
  - destruct (F eq_refl) as [R [B N]]. rewrite R. split; [assumption |].
    split; [discriminate |]. intros _. split; [assumption |].
    apply fresh_knowledge; assumption.
  - destruct (S eq_refl) as [R [Ht [H1 [Hn N]]]]. rewrite R. split.
    { pose proof (pos_INR (count t)). nra. }
    split; [| discriminate]. intros _.
    pose proof (decisions_le q (heard t) t Ht).
    apply (silent_knowledge p q t (heard t) (decisions q t - decisions q (heard t))); auto; lia.
Qed.

End Hearing.
