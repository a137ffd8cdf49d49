(* Clocks: decisions at real instants give the events of [Rule].

   Robot [p] makes its decision number [i] at the instant [own i], robot [q] its decision [j] at
   [others j]. Two decisions of one robot are at least [step] apart. A decision may have used the
   beacon of a decision of the other robot that is earlier ([p_heard], [q_heard]); nothing is
   assumed of the delay.

   Two decisions are at one event if neither used the other's beacon and they are less than a
   window apart. The window serves the proof only: it can be any part of a step up to one half.

   [all_earlier]     Each decision that is before an event of [p] is earlier than the decision of
                     [p]; it is a window earlier, unless [p] has heard it.
   [heard_is_before] Each decision that [p] has heard is before the event.
   [count_by_age]    If the latest beacon is [age] old, then the other robot has decided at most
                     [(age - window) / step] times since.
   [fresh_by_age]    So its last decision is known if [age] is below [step + window].
   [stored_count]    In [k] steps of [p] that take less than [(k + 1) * step - window], the other
                     robot decides at most [k + 1] times. One spare decision thus covers all
                     jitter: the first stored bound is halved twice, each later one once.
   [clocks_run]      At each instant both bodies are on their paths before or after one event, as
                     [Never.runs] demands.
   [never_touch_by_the_clock]
                     All together: two bodies that decide at these instants, hear each other in
                     any pattern and follow the rule never touch. *)
From Coq Require Import Reals Lra Lia Arith Psatz.
Require Import Space Rule Course Invariant Hearing Never.
Open Scope R_scope.

Section Clock.

Variables own others : nat -> R.
Variables p_heard q_heard : nat -> nat -> bool.
Variables step window : R.
Hypothesis window_pos : 0 < window.
Hypothesis window_short : 2 * window <= step.
Hypothesis own_steps : forall i, own i + step <= own (S i).
Hypothesis others_steps : forall j, others j + step <= others (S j).
Hypothesis p_hears : forall i j, p_heard i j = true -> others j < own i.
Hypothesis q_hears : forall i j, q_heard j i = true -> own i < others j.

(* Whether a decision at [a] is before that at [b], which has heard it or not. *)
Definition first (a b : R) (is_heard : bool) : bool :=
  if Rle_dec (a + window) b then true else is_heard.

Definition next (done : nat * nat) : nat * nat :=
  let (i, j) := done in
  if first (own i) (others j) (q_heard j i) then (S i, j)
  else if first (others j) (own i) (p_heard i j) then (i, S j)
  else (S i, S j).

(* How many decisions of both robots are before event t. *)
Fixpoint done (t : nat) : nat * nat := match t with O => (O, O) | S t => next (done t) end.
Definition mine t := fst (done t).
Definition theirs t := snd (done t).

Inductive event (t : nat) : Prop :=
  | p_alone : mine (S t) = S (mine t) -> theirs (S t) = theirs t ->
      (own (mine t) + window <= others (theirs t)
       \/ q_heard (theirs t) (mine t) = true) -> event t
  | q_alone : mine (S t) = mine t -> theirs (S t) = S (theirs t) ->
      (others (theirs t) + window <= own (mine t)
       \/ p_heard (mine t) (theirs t) = true) -> event t
  | together : mine (S t) = S (mine t) -> theirs (S t) = S (theirs t) ->
      own (mine t) < others (theirs t) + window -> others (theirs t) < own (mine t) + window ->
      p_heard (mine t) (theirs t) = false -> event t.

Lemma each_event t : event t.
Proof.
  assert (E : done (S t) = next (done t)) by reflexivity.
  assert (M : mine (S t) = fst (next (done t))) by (unfold mine; rewrite E; reflexivity).
  assert (N : theirs (S t) = snd (next (done t))) by (unfold theirs; rewrite E; reflexivity).
  assert (D : done t = (mine t, theirs t)) by apply surjective_pairing.
  clear E. rewrite D in M, N. unfold next, first in M, N.
  destruct (Rle_dec (own (mine t) + window) (others (theirs t))) as [A | A];
    [apply p_alone; auto |].
  destruct (q_heard (theirs t) (mine t)) eqn:Q; [apply p_alone; auto |].
  destruct (Rle_dec (others (theirs t) + window) (own (mine t))) as [B | B];
    [apply q_alone; auto |].
  destruct (p_heard (mine t) (theirs t)) eqn:P; [apply q_alone; auto |].
  apply together; auto; lra.
Qed.

Lemma steps_apart (times : nat -> R) : (forall i, times i + step <= times (S i)) ->
  forall n i, times i + INR n * step <= times (i + n)%nat.
Proof.
  intros H n i. induction n as [| n IH].
  - rewrite Nat.add_0_r. simpl. lra.
  - rewrite Nat.add_succ_r, S_INR. specialize (H (i + n)%nat). lra.
Qed.

Lemma later (times : nat -> R) : (forall i, times i + step <= times (S i)) ->
  forall i j, (i < j)%nat -> times i + step <= times j.
Proof.
  intros H i j L. pose proof (steps_apart times H (j - i) i) as A.
  replace (i + (j - i))%nat with j in A by lia.
  assert (1 <= INR (j - i)) by (apply (le_INR 1); lia).
  assert (0 < step) by lra. nra.
Qed.

Lemma not_earlier (times : nat -> R) : (forall i, times i + step <= times (S i)) ->
  forall i j, (i <= j)%nat -> times i <= times j.
Proof.
  intros H i j L. destruct (Nat.eq_dec i j) as [-> | N]; [lra |].
  assert (L' : (i < j)%nat) by lia. pose proof (later times H i j L'). lra.
Qed.

Theorem all_earlier t :
  (forall j, (j < theirs t)%nat ->
     others j + window <= own (mine t) \/ p_heard (mine t) j = true)
  /\ (forall i, (i < mine t)%nat ->
     own i + window <= others (theirs t) \/ q_heard (theirs t) i = true).
Proof.
  induction t as [| t [Hq Hp]].
  { split; intros n H; unfold theirs, mine in H; simpl in H; lia. }
  assert (Q : forall j, (j < theirs t)%nat -> others j < own (mine t)).
  { intros j H. destruct (Hq j H) as [G | G]; [lra | apply p_hears; exact G]. }
  assert (P : forall i, (i < mine t)%nat -> own i < others (theirs t)).
  { intros i H. destruct (Hp i H) as [G | G]; [lra | apply q_hears; exact G]. }
  pose proof (own_steps (mine t)) as Sp. pose proof (others_steps (theirs t)) as Sq.
  destruct (each_event t) as [E1 E2 H | E1 E2 H | E1 E2 H1 H2 _]; rewrite E1, E2;
    split; intros n Hn.
  - left. specialize (Q n Hn). lra.
  - destruct (Nat.eq_dec n (mine t)) as [-> | N]; [exact H | apply Hp; lia].
  - destruct (Nat.eq_dec n (theirs t)) as [-> | N]; [exact H | apply Hq; lia].
  - left. specialize (P n Hn). lra.
  - left. destruct (Nat.eq_dec n (theirs t)) as [-> | N]; [lra |].
    assert (L : (n < theirs t)%nat) by lia. specialize (Q n L). lra.
  - left. destruct (Nat.eq_dec n (mine t)) as [-> | N]; [lra |].
    assert (L : (n < mine t)%nat) by lia. specialize (P n L). lra.
Qed.

Lemma before t j : (j < theirs t)%nat -> others j < own (mine t).
Proof.
  intros H. destruct (all_earlier t) as [G _]. destruct (G j H) as [L | L];
    [lra | apply p_hears; exact L].
Qed.

(* Robot [p] decides at event t. *)
Definition p_decides t := mine (S t) = S (mine t).

(* The decisions of [q] that are not before the event are not much earlier. *)
Lemma not_before t : p_decides t -> own (mine t) < others (theirs t) + window.
Proof.
  intros D. destruct (each_event t) as [_ _ [H | H] | E _ _ | _ _ H _ _].
  - lra.
  - apply q_hears in H. lra.
  - unfold p_decides in D. lia.
  - exact H.
Qed.

Theorem heard_is_before t j : p_decides t -> p_heard (mine t) j = true -> (j < theirs t)%nat.
Proof.
  intros D H. pose proof (p_hears _ _ H) as E.
  destruct (le_lt_dec (theirs t) j) as [L | L]; [exfalso | exact L].
  destruct (Nat.eq_dec j (theirs t)) as [-> | N].
  - destruct (each_event t) as [_ _ [G | G] | G _ _ | _ _ _ _ G].
    + lra.
    + apply q_hears in G. lra.
    + unfold p_decides in D. lia.
    + congruence.
  - assert (L' : (theirs t < j)%nat) by lia.
    pose proof (not_before t D). pose proof (later others others_steps (theirs t) j L'). lra.
Qed.

(* [j] is the latest decision that [p] has heard; [q] has made [n] others since. *)
Theorem count_by_age t j n : theirs t = (S j + n)%nat ->
  (forall j', (j < j')%nat -> p_heard (mine t) j' = false) ->
  n = 0%nat \/ INR n * step + window <= own (mine t) - others j.
Proof.
  intros H Latest. destruct n as [| n]; [left; reflexivity | right].
  pose proof (steps_apart others others_steps (S n) j) as A.
  assert (L : (j + S n < theirs t)%nat) by lia.
  destruct (all_earlier t) as [G _]. destruct (G _ L) as [E | E]; [lra |].
  rewrite Latest in E by lia. discriminate.
Qed.

Corollary fresh_by_age t j : (j < theirs t)%nat ->
  (forall j', (j < j')%nat -> p_heard (mine t) j' = false) ->
  own (mine t) - others j < step + window -> theirs t = S j.
Proof.
  intros L Latest Age. destruct (count_by_age t j (theirs t - S j)) as [E | E]; [lia | exact Latest
    | lia |].
  destruct (theirs t - S j)%nat as [| n] eqn:N; [lia |].
  rewrite S_INR in E. pose proof (pos_INR n). nra.
Qed.

Theorem stored_count b t k m : p_decides b -> theirs t = (theirs b + m)%nat ->
  own (mine t) - own (mine b) + window <= INR (S k) * step -> (m <= S k)%nat.
Proof.
  intros D H T. destruct (le_lt_dec m (S k)) as [L | L]; [exact L | exfalso].
  pose proof (steps_apart others others_steps (S k) (theirs b)) as A.
  assert (L' : (theirs b + S k < theirs t)%nat) by lia.
  pose proof (before t _ L'). pose proof (not_before b D). lra.
Qed.

(** * Bodies *)

(* [ends i]: the end of the path after [i] decisions. *)
Definition begin (ends : nat -> vec) (i : nat) := match i with O => ends O | S i => ends i end.

Definition course_of (ends : nat -> vec) (pauses : nat -> bool) (number : nat -> nat) := Course
  (fun t => ends (number t))
  (fun t => begin ends (number t))
  (fun t => negb (number (S t) =? number t))
  (fun t => pauses (number t)).

(* A pause is a decision to stand. *)
Definition pauses_stand ends pauses := forall i, pauses i = true -> ends (S i) = ends i :> vec.

Lemma course_moves ends pauses number : pauses_stand ends pauses ->
  (forall t, number (S t) = number t \/ number (S t) = S (number t)) ->
  moves (course_of ends pauses number).
Proof.
  intros Hp Hn. split; cbn [acts place base Rule.pauses course_of].
  - intros t H. apply Bool.negb_false_iff, Nat.eqb_eq in H. rewrite H. reflexivity.
  - intros t H P. apply Bool.negb_true_iff, Nat.eqb_neq in H.
    destruct (Hn t) as [E | E]; [lia |]. rewrite E. apply Hp, P.
  - intros t. exists 0. split; [unfold part; lra |]. unfold new_path, start.
    cbn [acts place base course_of]. rewrite point_0.
    destruct (Hn t) as [E | E]; rewrite E; [rewrite Nat.eqb_refl; reflexivity |].
    rewrite (proj2 (Nat.eqb_neq _ _)) by lia. reflexivity.
Qed.

(* After a number of decisions a body is on the path of the last one. *)
Definition on_its_path ends (i : nat) (body : vec) :=
  exists s, part s /\ body = point (begin ends i) (ends i) s.

Lemma at_old_or_new ends pauses number t i body :
  (forall t, number (S t) = number t \/ number (S t) = S (number t)) ->
  on_its_path ends i body -> i = number t \/ i = number (S t) ->
  exists side s, part s /\ body = path_at (course_of ends pauses number) t side s.
Proof.
  intros Hn [s [Hs ->]] [-> | ->].
  - exists false, s. split; [exact Hs | reflexivity].
  - exists true, s. split; [exact Hs |]. unfold path_at, new_path, start.
    cbn [acts place base course_of].
    destruct (Hn t) as [E | E]; rewrite E; [rewrite Nat.eqb_refl; reflexivity |].
    rewrite (proj2 (Nat.eqb_neq _ _)) by lia. reflexivity.
Qed.

Lemma number_mine t : mine (S t) = mine t \/ mine (S t) = S (mine t).
Proof. destruct (each_event t); auto. Qed.

Lemma number_theirs t : theirs (S t) = theirs t \/ theirs (S t) = S (theirs t).
Proof. destruct (each_event t); auto. Qed.

(* [i], [j] decisions have been made at the instant [now]. *)
Definition made (times : nat -> R) (now : R) (i : nat) :=
  forall n, (n < i)%nat <-> times n <= now.

Lemma grows t : (t <= mine t + theirs t)%nat.
Proof. induction t as [| t IH]; [lia |]. destruct (each_event t); lia. Qed.

Lemma last_event (P : nat -> bool) n : P 0%nat = true -> P n = false ->
  exists t, P t = true /\ P (S t) = false.
Proof.
  intros H0. induction n as [| n IH]; intros Hn; [congruence |].
  destruct (P n) eqn:E; [exists n; auto | apply IH; reflexivity].
Qed.

Lemma instant_has_event now i j : made own now i -> made others now j ->
  exists t, (i = mine t \/ i = mine (S t)) /\ (j = theirs t \/ j = theirs (S t)).
Proof.
  intros Hi Hj.
  destruct (last_event (fun t => (mine t <=? i) && (theirs t <=? j))%bool (S (i + j)))
    as [t [G L]].
  - reflexivity.
  - apply Bool.andb_false_iff. pose proof (grows (S (i + j))).
    destruct (le_lt_dec (mine (S (i + j))) i); [right | left]; apply Nat.leb_gt; lia.
  - apply Bool.andb_true_iff in G. destruct G as [Gi Gj].
    apply Nat.leb_le in Gi. apply Nat.leb_le in Gj.
    assert (Li : (mine t < i)%nat \/ (i = mine t /\ now < own (mine t))).
    { destruct (Nat.eq_dec i (mine t)) as [E | N]; [right | left; lia]. split; [exact E |].
      destruct (Rlt_le_dec now (own (mine t))) as [Y | Y]; [exact Y |].
      apply Hi in Y. lia. }
    assert (Lj : (theirs t < j)%nat \/ (j = theirs t /\ now < others (theirs t))).
    { destruct (Nat.eq_dec j (theirs t)) as [E | N]; [right | left; lia]. split; [exact E |].
      destruct (Rlt_le_dec now (others (theirs t))) as [Y | Y]; [exact Y |].
      apply Hj in Y. lia. }
    exists t. apply Bool.andb_false_iff in L. rewrite !Nat.leb_gt in L.
    pose proof (own_steps (mine t)) as Sp. pose proof (others_steps (theirs t)) as Sq.
    destruct (each_event t) as [E1 E2 H | E1 E2 H | E1 E2 H1 H2 _]; rewrite E1, E2 in *.
    + (* [p] alone: it has not decided yet, and neither has [q]. *)
      destruct Li as [Li | [Ei Ti]]; [lia |]. split; [left; exact Ei | left].
      destruct Lj as [Lj | [Ej _]]; [exfalso | exact Ej].
      apply Hj in Lj. destruct H as [H | H]; [lra | apply q_hears in H; lra].
    + destruct Lj as [Lj | [Ej Tj]]; [lia |]. split; [left | left; exact Ej].
      destruct Li as [Li | [Ei _]]; [exfalso | exact Ei].
      apply Hi in Li. destruct H as [H | H]; [lra | apply p_hears in H; lra].
    + assert (Ni : (i <= S (mine t))%nat).
      { destruct (le_lt_dec i (S (mine t))) as [Y | Y]; [exact Y | exfalso].
        pose proof (proj1 (Hi _) Y). destruct L as [L | L]; [lia |].
        destruct Lj as [Lj | [_ Tj]]; [lia | lra]. }
      assert (Nj : (j <= S (theirs t))%nat).
      { destruct (le_lt_dec j (S (theirs t))) as [Y | Y]; [exact Y | exfalso].
        pose proof (proj1 (Hj _) Y). destruct L as [L | L]; [| lia].
        destruct Li as [Li | [_ Ti]]; [lia | lra]. }
      lia.
Qed.

(* The bodies follow their decisions. *)
Theorem clocks_run ends_p ends_q pauses_p pauses_q (body body' : R -> vec) :
  pauses_stand ends_p pauses_p -> pauses_stand ends_q pauses_q ->
  (forall now, exists i, made own now i /\ on_its_path ends_p i (body now)) ->
  (forall now, exists j, made others now j /\ on_its_path ends_q j (body' now)) ->
  moves (course_of ends_p pauses_p mine) /\ moves (course_of ends_q pauses_q theirs)
  /\ runs R body body' (course_of ends_p pauses_p mine) (course_of ends_q pauses_q theirs).
Proof.
  intros Pp Pq Bp Bq.
  split; [apply course_moves; [exact Pp | exact number_mine] |].
  split; [apply course_moves; [exact Pq | exact number_theirs] |].
  intros now. destruct (Bp now) as [i [Mi Oi]]. destruct (Bq now) as [j [Mj Oj]].
  destruct (instant_has_event now i j Mi Mj) as [t [Hi Hj]].
  destruct (at_old_or_new ends_p pauses_p mine t i _ number_mine Oi Hi) as [a [s [Hs Es]]].
  destruct (at_old_or_new ends_q pauses_q theirs t j _ number_theirs Oj Hj) as [b [r [Hr Er]]].
  exists t, a, b, s, r. auto.
Qed.

Lemma mine_is_decisions ends pauses t : decisions (course_of ends pauses mine) t = mine t.
Proof.
  induction t as [| t IH]; [reflexivity |]. cbn [decisions acts course_of]. rewrite IH.
  destruct (number_mine t) as [E | E]; rewrite E; [rewrite Nat.eqb_refl; reflexivity |].
  rewrite (proj2 (Nat.eqb_neq _ _)) by lia. reflexivity.
Qed.

Lemma theirs_is_decisions ends pauses t : decisions (course_of ends pauses theirs) t = theirs t.
Proof.
  induction t as [| t IH]; [reflexivity |]. cbn [decisions acts course_of]. rewrite IH.
  destruct (number_theirs t) as [E | E]; rewrite E; [rewrite Nat.eqb_refl; reflexivity |].
  rewrite (proj2 (Nat.eqb_neq _ _)) by lia. reflexivity.
Qed.

(* All together: two bodies that move by their clocks and follow the rule never touch. *)
Theorem never_touch_by_the_clock radii margin error slack fastest
    ends_p ends_q pauses_p pauses_q (body body' : R -> vec) kp kq
    heard_p heard_q count_p count_q :
  let p := course_of ends_p pauses_p mine in
  let q := course_of ends_q pauses_q theirs in
  0 < radii -> 0 <= slack -> 0 <= error -> 0 <= fastest -> error + 2 * slack <= margin ->
  pauses_stand ends_p pauses_p -> pauses_stand ends_q pauses_q ->
  (forall now, exists i, made own now i /\ on_its_path ends_p i (body now)) ->
  (forall now, exists j, made others now j /\ on_its_path ends_q j (body' now)) ->
  (forall i, dist (ends_p (S i)) (ends_p i) <= fastest) ->
  (forall j, dist (ends_q (S j)) (ends_q j) <= fastest) ->
  hears fastest error p q kp heard_p count_p -> hears fastest error q p kq heard_q count_q ->
  follows (1 / 2) (radii + margin - error) slack fastest p q kp ->
  follows (1 / 2) (radii + margin - error) slack fastest q p kq ->
  radii + margin <= dist (ends_q 0%nat) (ends_p 0%nat) ->
  forall now, radii <= dist (body' now) (body now).
Proof.
  intros p q R0 S0 E0 F0 M Pp Pq Bp Bq Lp Lq Hp Hq Fp Fq H0.
  destruct (clocks_run ends_p ends_q pauses_p pauses_q body body' Pp Pq Bp Bq)
    as [Mp [Mq Run]]. fold p in Mp, Run. fold q in Mq, Run.
  assert (Slow : forall ends pauses number, number 0%nat = 0%nat ->
    (forall t, number (S t) = number t \/ number (S t) = S (number t)) ->
    (forall i, dist (ends (S i)) (ends i) <= fastest) ->
    slow fastest (course_of ends pauses number)).
  { intros ends pauses number Z N L. split; [simpl; rewrite Z; reflexivity |].
    intros t. unfold motion. cbn [place course_of]. destruct (N t) as [-> | ->]; [| apply L].
    rewrite sub_self, norm_zero. exact F0. }
  apply (never_at_any_instant margin error slack fastest S0 E0 F0 M R body body' radii p q kp kq
    heard_p heard_q count_p count_q); try assumption.
  - split; [exact Mp |]. split; [| split; assumption].
    apply Slow; [reflexivity | exact number_mine | exact Lp].
  - split; [exact Mq |]. split; [| split; assumption].
    apply Slow; [reflexivity | exact number_theirs | exact Lq].
Qed.

End Clock.
