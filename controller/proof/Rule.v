(* The rule of [GapLimit] for one pair of robots. This file has definitions only.

   Time is a sequence of events. At an event either robot decides, or both do. Any pattern is
   possible. Two decisions are at one event if neither robot can know of the other's decision.

   A robot is on its path: the straight line from the place of its last decision to its end. It
   may be anywhere on the path, at any speed, also stationary. Its next decision comes when it
   has arrived at the end, or later.

   The rule for a decision that is not a pause:

   [bounds]   The gap is at most that of the ball in which the other robot is, or nothing, or the
              bound stored by the own last decision: half of the gap minus the approach of the own
              motion. A motion that recedes adds nothing.
   [stands]   A robot stands if the other robot can be at its own place.
   [counts]   [taken] is the largest approach to any place where the other robot may be.
   [limits]   [taken] is at most half of the gap. It may be the whole gap if the other robot is
              known to pause, and all but the longest motion of the other robot if that is less
              than half.
   [keeps_off]
              The other robot's last decision is known (fresh), but it may still be on that path:
              the own motion stays on its side of a plane that has the path behind it, or it
              leads away from the whole path. *)
From Coq Require Import Reals Lra Arith.
Require Import Space.
Open Scope R_scope.

(* The decisions of a robot. [place c t]: the end of its path before event t. [base c t]: a point of
   that path which it has not left behind before event t. [pauses]: it stands, and it forgets all
   stored bounds. *)
Record course := Course {
  place : nat -> vec;
  base : nat -> vec;
  acts : nat -> bool;
  pauses : nat -> bool
}.

Definition motion c t := sub (place c (S t)) (place c t).

(* Where the path after event t begins. *)
Definition start c t := if acts c t then place c t else base c t.

(* Points of the path before event t, and of the path after it. *)
Definition old_path c t s := point (base c t) (place c t) s.
Definition new_path c t s := point (start c t) (place c (S t)) s.

Definition decides c t := acts c t = true /\ pauses c t = false.

Record moves (c : course) : Prop := {
  rests : forall t, acts c t = false -> place c (S t) = place c t;
  halts : forall t, acts c t = true -> pauses c t = true -> place c (S t) = place c t;
  (* Time passes only forwards along a path. *)
  advances : forall t, exists s, part s /\ base c (S t) = new_path c t s
}.

(* The number of decisions before event t. *)
Fixpoint decisions (c : course) (t : nat) : nat :=
  match t with
  | O => O
  | S t => if acts c t then S (decisions c t) else decisions c t
  end.

(* [b] is the decision before that of event [t]. *)
Definition last c b t := (b < t)%nat /\ forall u, (b < u < t)%nat -> acts c u = false.

(* After event t the other robot stands, since its last decision is a pause. *)
Definition paused c t := exists b, (b <= t)%nat /\ acts c b = true /\ pauses c b = true
  /\ forall u, (b < u <= t)%nat -> acts c u = false.

(* The knowledge of a robot about another one at its decision of event t. Places are offsets from
   the own place.

   fresh:  whether it knows the other robot's last decision;
   seen:   fresh: the end of the other robot's path; else the centre of a ball that has all of
           this path;
   reach:  radius of the ball; fresh: error of the path (rounding);
   begun:  fresh: where the path begins;
   aside, clear: fresh: a direction, and the distance of the path along it;
   gap, taken: bound of the gap, and the part of it that the own motion takes;
   halved: how often the stored bound was halved since the decision before;
   spare:  how many more decisions of the other robot the bound allows for. The controller does
           not compute it; it only counts for the proof. *)
Record view := View {
  fresh : nat -> bool;
  seen : nat -> vec;
  reach : nat -> R;
  begun : nat -> vec;
  aside : nat -> vec;
  clear : nat -> R;
  gap : nat -> R;
  taken : nat -> R;
  halved : nat -> nat;
  spare : nat -> nat
}.

Definition offset p q t := sub (place q t) (place p t).

(* The knowledge is right: the other robot is where it is taken to be. *)
Definition knows p q k := forall t, decides p t -> 0 <= reach k t
  /\ (fresh k t = false -> forall s, part s ->
        norm (sub (sub (old_path q t s) (place p t)) (seen k t)) <= reach k t)
  /\ (fresh k t = true ->
        norm (sub (offset p q t) (seen k t)) <= reach k t
        /\ forall s, part s -> exists s', part s'
          /\ norm (sub (sub (old_path q t s) (place p t)) (point (begun k t) (seen k t) s'))
               <= reach k t).

Section Rule.

(* share:   the largest part of a gap that a robot takes;
   keep:    the distance of the centres that remains, but for twice the slack;
   slack:   excess accepted in a decision (TOLERANCE_UM);
   fastest: the longest motion of a decision. *)
Variables share keep slack fastest : R.

Definition direction k t := unit (seen k t).
Definition slant k t := reach k t / norm (seen k t).
Definition tilt k t := reach k t / (norm (seen k t) - reach k t / 2).

(* The gap to the other robot's path along [aside], and its rest after the own motion. *)
Definition beyond k t := clear k t - reach k t - keep.
Definition left_aside p k t := beyond k t + 2 * slack - dot (aside k t) (motion p t).

(* The motion leads away from all of the other robot's path. *)
Definition retreats p k t :=
  dot (begun k t) (motion p t) + reach k t * norm (motion p t) <= 0
  /\ dot (seen k t) (motion p t) + reach k t * norm (motion p t) <= 0.

(* A bound stored by the decision at [b] for the next one, after [j] halvings. *)
Definition stored k b j :=
  (1 - share) ^ j * (gap k b + 2 * slack) - Rmax (taken k b) 0 - 2 * slack.

(* Both decided at event [b], and neither since: then receding counts, too. *)
Definition stored_together k b := (1 - share) * gap k b - taken k b - slack.

Definition ball k t := norm (seen k t) - keep - reach k t.

Record keeps_gap (p q : course) (k : view) : Prop := {
  bounds : forall t, decides p t ->
    (gap k t <= ball k t /\ spare k t = 0%nat)
    \/ gap k t <= - 2 * slack
    \/ exists b, last p b t /\ decides p b
       /\ (fresh k b = true -> decisions q t = decisions q b -> base q t = place q t
             \/ 2 ^ spare k t * (gap k t + 2 * slack) <= left_aside p k b)
       /\ ((gap k t <= stored k b (halved k t)
            /\ (spare k t + decisions q t <= spare k b + halved k t + decisions q b)%nat)
           \/ (gap k t <= stored_together k b
               /\ spare k t = 0%nat /\ acts q b = true
               /\ decisions q t = S (decisions q b)));
  stands : forall t, decides p t -> norm (seen k t) <= reach k t ->
    place p (S t) = place p t /\ 0 <= taken k t;
  counts : forall t, decides p t -> reach k t < norm (seen k t) ->
    towards (direction k t) (motion p t) (slant k t) <= taken k t
    \/ narrow (direction k t) (motion p t) (tilt k t) <= taken k t;
  limits : forall t, decides p t ->
    taken k t <= Rmax (share * gap k t + slack) 0
    \/ (norm (motion p t) <= fastest /\ taken k t <= gap k t - fastest)
    \/ (paused q t /\ taken k t <= Rmax (gap k t + slack) 0)
}.

Record follows (p q : course) (k : view) : Prop := {
  gap_kept :> keeps_gap p q k;
  keeps_off : forall t, decides p t -> fresh k t = true ->
    norm (aside k t) <= 1 /\ clear k t <= dot (aside k t) (begun k t)
    /\ clear k t <= dot (aside k t) (seen k t)
    /\ (place p (S t) = place p t \/ retreats p k t
        \/ (- 2 * slack <= beyond k t
            /\ dot (aside k t) (motion p t) <= Rmax (beyond k t + slack) 0))
}.

End Rule.
