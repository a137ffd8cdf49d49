(* The theorems: robots that follow the rule never touch.

   radii:  sum of both radii;
   margin: the gap that the rule keeps beside them (ROUNDING_MM);
   error:  largest error of an offset; slack: accepted excess of a decision (TOLERANCE_UM).
   The margin must cover the error and twice the slack.

   [two_robots_never_touch]  At any event, before it and after it, all points of the one path are
                             at least [radii] away from all points of the other path. Packets are
                             lost or late in any pattern; decisions come at any instants.
   [never_at_any_instant]    Therefore the bodies never touch, wherever they are on their paths.
   [no_two_robots_touch]     The same for any number of robots. Each pair has its own order of
                             events; each robot has one body and follows the rule for each pair.
   [in_step_never_touch]     All robots decide at the same instants, and all paths are over then.
                             The rule needs no plane ([keeps_off]) in this case.
   [exactly_never_touch]     Without errors and without slack no margin is needed. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule Course Invariant Hearing.
Open Scope R_scope.

(* The assumptions on one robot towards another one. *)
Definition safe radii margin error slack fastest p q k heard count :=
  moves p /\ slow fastest p /\ hears fastest error p q k heard count
  /\ follows (1 / 2) (radii + margin - error) slack fastest p q k.

Section Sizes.

Variables margin error slack fastest : R.
Hypothesis slack_nonneg : 0 <= slack.
Hypothesis error_nonneg : 0 <= error.
Hypothesis fastest_nonneg : 0 <= fastest.
Hypothesis margin_large : error + 2 * slack <= margin.

Theorem two_robots_never_touch radii p q kp kq heard_p heard_q count_p count_q :
  0 < radii ->
  safe radii margin error slack fastest p q kp heard_p count_p ->
  safe radii margin error slack fastest q p kq heard_q count_q ->
  radii + margin <= dist (place q 0) (place p 0) ->
  forall t i j s r, part s -> part r ->
  radii <= dist (path_at q t j r) (path_at p t i s).
Proof.
  intros R0 [Mp [Lp [Hp Fp]]] [Mq [Lq [Hq Fq]]] H0 t i j s r Hs Hr.
  set (keep := radii + margin - error) in *.
  assert (Large : 2 * slack < keep) by (unfold keep; lra).
  assert (Kp : knows p q kp)
    by (apply (hearing_is_knowing fastest error) with heard_p count_p; assumption).
  assert (Kq : knows q p kq)
    by (apply (hearing_is_knowing fastest error) with heard_q count_q; assumption).
  assert (A : apart keep slack p q 0).
  { intros s' r' _ _. unfold old_path. destruct Lp as [-> _], Lq as [-> _].
    rewrite !point_same. unfold floor, keep. lra. }
  pose proof (paths_never_meet (1 / 2) keep slack fastest eq_refl slack_nonneg Large p q kp kq
    Mp Mq Kp Kq Fp Fq A t i j s r Hs Hr) as G.
  unfold floor, keep in G. lra.
Qed.

(* [instant]: any kind of time. At each instant both bodies are on their paths before or after
   the same event. *)
Definition runs (instant : Type) (body body' : instant -> vec) p q := forall now,
  exists t i j s r, part s /\ part r
    /\ body now = path_at p t i s /\ body' now = path_at q t j r.

Corollary never_at_any_instant (instant : Type) body body' radii p q kp kq
    heard_p heard_q count_p count_q :
  0 < radii ->
  safe radii margin error slack fastest p q kp heard_p count_p ->
  safe radii margin error slack fastest q p kq heard_q count_q ->
  radii + margin <= dist (place q 0) (place p 0) ->
  runs instant body body' p q ->
  forall now, radii <= dist (body' now) (body now).
Proof.
  intros R0 Sp Sq H0 Run now. destruct (Run now) as [t [i [j [s [r [Hs [Hr [-> ->]]]]]]]].
  apply (two_robots_never_touch radii p q kp kq heard_p heard_q count_p count_q); assumption.
Qed.

(* [course i j]: the decisions of robot [i], in the order of events of the pair [i], [j]. *)
Theorem no_two_robots_touch (robot instant : Type) (body : robot -> instant -> vec)
    (radius : robot -> R) (course : robot -> robot -> Rule.course)
    (knowledge : robot -> robot -> view) (heard count : robot -> robot -> nat -> nat) :
  (forall i, 0 < radius i) ->
  (forall i j, i <> j -> safe (radius i + radius j) margin error slack fastest
    (course i j) (course j i) (knowledge i j) (heard i j) (count i j)) ->
  (forall i j, i <> j ->
    radius i + radius j + margin <= dist (place (course j i) 0) (place (course i j) 0)) ->
  (forall i j, i <> j -> runs instant (body i) (body j) (course i j) (course j i)) ->
  forall now i j, i <> j -> radius i + radius j <= dist (body j now) (body i now).
Proof.
  intros Hr Hs H0 Hrun now i j N. assert (N' : j <> i) by congruence.
  pose proof (Hs j i N') as Sj. rewrite (Rplus_comm (radius j)) in Sj.
  apply (never_at_any_instant instant (body i) (body j) (radius i + radius j)
    (course i j) (course j i) (knowledge i j) (knowledge j i) (heard i j) (heard j i)
    (count i j) (count j i)); auto.
  pose proof (Hr i). pose proof (Hr j). lra.
Qed.

End Sizes.

(** * All robots in step *)

(* Paths are over when the robots decide. *)
Definition in_step c := forall t, acts c t = true /\ base c t = place c t.

(* A robot then only needs to know the end. *)
Definition knows_end p q k := forall t, pauses p t = false ->
  0 <= reach k t /\ norm (sub (offset p q t) (seen k t)) <= reach k t.

Definition unplanned k := View (fun _ => false) (seen k) (reach k) (begun k) (aside k) (clear k)
  (gap k) (taken k) (halved k) (spare k).

Theorem in_step_never_touch radii margin error slack fastest p q kp kq :
  0 < radii -> 0 <= slack -> error + 2 * slack <= margin ->
  let keep := radii + margin - error in
  moves p -> moves q -> in_step p -> in_step q ->
  knows_end p q kp -> knows_end q p kq ->
  keeps_gap (1 / 2) keep slack fastest p q kp -> keeps_gap (1 / 2) keep slack fastest q p kq ->
  radii + margin <= dist (place q 0) (place p 0) -> 0 <= error ->
  forall t s r, part s -> part r -> radii <= dist (new_path q t r) (new_path p t s).
Proof.
  intros R0 S0 M keep Mp Mq Ip Iq Kp Kq Fp Fq H0 E0 t s r Hs Hr.
  assert (Know : forall a b k, in_step b -> knows_end a b k -> knows a b (unplanned k)).
  { intros a b k I K u [_ D]. destruct (K u D) as [Hreach Hend]. simpl.
    split; [assumption |]. split; [| discriminate]. intros _ s' _. unfold old_path.
    destruct (I u) as [_ ->]. rewrite point_same. exact Hend. }
  assert (Follow : forall a b k, keeps_gap (1 / 2) keep slack fastest a b k ->
    follows (1 / 2) keep slack fastest a b (unplanned k)).
  { intros a b k [B St C L]. split; [| intros u _; discriminate].
    split; [| exact St | exact C | exact L].
    intros u D. destruct (B u D) as [G | [G | [v [La [Dv [_ G]]]]]];
      [left; exact G | right; left; exact G |].
    right; right. exists v. repeat split; try apply La; try apply Dv; try discriminate.
    exact G. }
  assert (Large : 2 * slack < keep) by (unfold keep; lra).
  assert (A : apart keep slack p q 0).
  { intros s' r' _ _. unfold old_path. destruct (Ip 0%nat) as [_ ->], (Iq 0%nat) as [_ ->].
    rewrite !point_same. unfold floor, keep. lra. }
  pose proof (paths_never_meet (1 / 2) keep slack fastest eq_refl S0 Large p q
    (unplanned kp) (unplanned kq) Mp Mq (Know p q kp Iq Kp) (Know q p kq Ip Kq)
    (Follow p q kp Fp) (Follow q p kq Fq) A t true true s r Hs Hr) as G.
  unfold path_at, floor, keep in G. lra.
Qed.

Corollary exactly_never_touch radii fastest p q kp kq heard_p heard_q count_p count_q :
  0 < radii -> 0 <= fastest ->
  safe radii 0 0 0 fastest p q kp heard_p count_p ->
  safe radii 0 0 0 fastest q p kq heard_q count_q ->
  radii <= dist (place q 0) (place p 0) ->
  forall t i j s r, part s -> part r -> radii <= dist (path_at q t j r) (path_at p t i s).
Proof.
  intros R0 F0 Sp Sq H0.
  apply (two_robots_never_touch 0 0 0 fastest) with kp kq heard_p heard_q count_p count_q;
    try lra; assumption.
Qed.

Print Assumptions no_two_robots_touch.
