(* Space: vectors, paths, and the geometry of a motion that comes nearer to another robot.

   [approach]         Both robots move. Their new distance is at least the old one minus the
                      approaches of both motions along the line between the robots.
   [beside]           A motion that stays on its side of a plane keeps its distance from all
                      points behind the plane.
   [cone]             The other robot is in a ball. [towards] is the largest approach of a
                      motion to any place in the ball. [cone_is_tight]: no smaller bound holds.
   [narrow]           A simpler bound if the direction of the other robot is nearly known.
   [sine_alone_is_too_weak]
                      Without the cosine of the cone, a robot that seems to recede can approach.

   Heights are divided by the downwash, as [GapLimit::lowered] does. The plane is z = 0. *)
From Coq Require Import Reals Lra Psatz.
Open Scope R_scope.

Record vec := V { x : R; y : R; z : R }.

Definition add u v := V (x u + x v) (y u + y v) (z u + z v).
Definition sub u v := V (x u - x v) (y u - y v) (z u - z v).
Definition scale k u := V (k * x u) (k * y u) (k * z u).
Definition dot u v := x u * x v + y u * y v + z u * z v.
Definition norm u := sqrt (dot u u).
Definition dist u v := norm (sub u v).
Definition zero := V 0 0 0.

(* The point of the straight path from [a] to [b] at the part [s] of it, 0 to 1. *)
Definition point a b s := add a (scale s (sub b a)).

Definition part (s : R) := 0 <= s <= 1.

Ltac coordinates := intros; repeat match goal with u : vec |- _ => destruct u end;
  unfold point, add, sub, scale, dot, zero in *; simpl in *.

(* Two vectors are equal if their coordinates are. *)
Ltac same := coordinates; f_equal; ring.

(** * Lengths *)

Lemma square_nonneg a : 0 <= a * a.
Proof. exact (Rle_0_sqr a). Qed.

Lemma dot_self u : 0 <= dot u u.
Proof.
  unfold dot. pose proof (square_nonneg (x u)). pose proof (square_nonneg (y u)).
  pose proof (square_nonneg (z u)). lra.
Qed.

Lemma norm_nonneg u : 0 <= norm u.
Proof. apply sqrt_pos. Qed.

Lemma norm_sq u : norm u * norm u = dot u u.
Proof. apply sqrt_sqrt, dot_self. Qed.

Lemma square_le a b : 0 <= b -> a * a <= b * b -> a <= b.
Proof. intros Hb H. apply Rsqr_incr_0_var; assumption. Qed.

Lemma norm_le u k : 0 <= k -> dot u u <= k * k -> norm u <= k.
Proof. intros Hk H. apply square_le; [assumption | rewrite norm_sq; assumption]. Qed.

Lemma norm_is u k : 0 <= k -> dot u u = k * k -> norm u = k.
Proof. intros Hk H. unfold norm. rewrite H. apply sqrt_square; assumption. Qed.

Lemma norm_zero : norm zero = 0.
Proof. apply norm_is; [lra |]. unfold dot, zero; simpl; ring. Qed.

Lemma norm_scale k u : 0 <= k -> norm (scale k u) = k * norm u.
Proof.
  intros Hk. apply norm_is.
  - apply Rmult_le_pos; [assumption | apply norm_nonneg].
  - replace (k * norm u * (k * norm u)) with (k * k * (norm u * norm u)) by ring.
    rewrite norm_sq. unfold dot, scale; simpl; ring.
Qed.

Lemma lagrange u v : dot u v * dot u v <= dot u u * dot v v.
Proof.
  pose proof (square_nonneg (x u * y v - y u * x v)).
  pose proof (square_nonneg (x u * z v - z u * x v)).
  pose proof (square_nonneg (y u * z v - z u * y v)).
  unfold dot. lra.
Qed.

Lemma cauchy u v : dot u v <= norm u * norm v.
Proof.
  apply square_le.
  - apply Rmult_le_pos; apply norm_nonneg.
  - replace (norm u * norm v * (norm u * norm v)) with ((norm u * norm u) * (norm v * norm v))
      by ring.
    rewrite !norm_sq. apply lagrange.
Qed.

Lemma dot_sym u v : dot u v = dot v u.
Proof. unfold dot; ring. Qed.

Lemma triangle u v : norm (add u v) <= norm u + norm v.
Proof.
  pose proof (norm_nonneg u). pose proof (norm_nonneg v). pose proof (cauchy u v).
  apply norm_le; [lra |].
  replace (dot (add u v) (add u v)) with (dot u u + 2 * dot u v + dot v v)
    by (unfold dot, add; simpl; ring).
  rewrite <- (norm_sq u), <- (norm_sq v). lra.
Qed.

Lemma dist_sym u v : dist u v = dist v u.
Proof. unfold dist, norm. f_equal. unfold dot, sub; simpl; ring. Qed.

Lemma dist_self u : dist u u = 0.
Proof. unfold dist. replace (sub u u) with zero by same. apply norm_zero. Qed.

Lemma dist_triangle u v w : dist u w <= dist u v + dist v w.
Proof.
  unfold dist. replace (sub u w) with (add (sub u v) (sub v w)) by same. apply triangle.
Qed.

Lemma norm_dist u v : norm u <= norm v + dist u v.
Proof. unfold dist. replace u with (add v (sub u v)) at 1 by same. apply triangle. Qed.

(** * Paths *)

Lemma point_0 a b : point a b 0 = a.
Proof. same. Qed.

Lemma point_1 a b : point a b 1 = b.
Proof. same. Qed.

Lemma add_zero u s : add u (scale s zero) = u.
Proof. same. Qed.

Lemma sub_self u : sub u u = zero.
Proof. same. Qed.

Lemma point_same a s : point a a s = a.
Proof. same. Qed.

Lemma point_dist a b s : part s -> dist (point a b s) a <= dist b a.
Proof.
  intros [H0 H1]. unfold dist. replace (sub (point a b s) a) with (scale s (sub b a)) by same.
  rewrite norm_scale by assumption. pose proof (norm_nonneg (sub b a)). nra.
Qed.

(* The rest of a path is on the path. *)
Lemma point_rest a b r s : part r -> part s ->
  exists s', part s' /\ point (point a b r) b s = point a b s'.
Proof.
  intros [R0 R1] [S0 S1]. exists (r + s * (1 - r)). split; [unfold part; nra | same].
Qed.

(** * Motions *)

(* How much nearer the motion [m] comes to a robot with the offset [w], along the line to it. *)
Definition approach w m := dot w m / norm w.

Lemma approach_zero w : approach w zero = 0.
Proof. unfold approach. replace (dot w zero) with 0 by (unfold dot, zero; simpl; ring). lra. Qed.

Lemma approach_le w m k : 0 < norm w -> dot w m <= norm w * k -> approach w m <= k.
Proof.
  intros Hw H. unfold approach. apply Rmult_le_reg_l with (norm w); [assumption |].
  replace (norm w * (dot w m / norm w)) with (dot w m) by (field; lra). assumption.
Qed.

Lemma approach_norm w m : 0 < norm w -> approach w m <= norm m.
Proof. intros Hw. apply approach_le; [assumption | apply cauchy]. Qed.

Lemma approach_opp w m : approach (scale (-1) w) m = - approach w m.
Proof.
  unfold approach.
  replace (norm (scale (-1) w)) with (norm w)
    by (unfold norm; f_equal; unfold dot, scale; simpl; ring).
  replace (dot (scale (-1) w) m) with (- dot w m) by (unfold dot, scale; simpl; ring).
  unfold Rdiv. ring.
Qed.

(* The distance after a relative motion [m] is at least its part along the line. *)
Lemma along w m : 0 < norm w -> norm w + approach w m <= norm (add w m).
Proof.
  intros Hw. apply Rmult_le_reg_l with (norm w); [assumption |].
  replace (norm w * (norm w + approach w m)) with (norm w * norm w + dot w m)
    by (unfold approach; field; lra).
  rewrite norm_sq. replace (dot w w + dot w m) with (dot w (add w m))
    by (unfold dot, add; simpl; ring).
  apply cauchy.
Qed.

(* Robots at [p] and [q] have covered the parts [s] and [r] of their motions [m] and [n]. *)
Lemma approach_both p q m n s r : 0 < dist q p ->
  dist q p - s * approach (sub q p) m - r * approach (sub p q) n
    <= dist (add q (scale r n)) (add p (scale s m)).
Proof.
  intros Hw. unfold dist in *.
  replace (sub (add q (scale r n)) (add p (scale s m)))
    with (add (sub q p) (sub (scale r n) (scale s m))) by same.
  eapply Rle_trans; [| apply along; assumption].
  replace (sub p q) with (scale (-1) (sub q p)) by same. rewrite approach_opp.
  unfold approach.
  replace (dot (sub q p) (sub (scale r n) (scale s m)))
    with (r * dot (sub q p) n - s * dot (sub q p) m) by (unfold dot, sub, scale; simpl; ring).
  apply Req_le. field. lra.
Qed.

(* Only one robot moves. *)
Lemma approach_one p q m s k : 0 < dist q p -> part s -> approach (sub q p) m <= k -> 0 <= k ->
  dist q p - k <= dist q (add p (scale s m)).
Proof.
  intros Hw [S0 S1] Ha Hk. pose proof (approach_both p q m zero s 0 Hw) as A.
  replace (add q (scale 0 zero)) with q in A by same. nra.
Qed.

(* [u]: a direction. All of a place [o] behind the plane at the distance [clear] in this
   direction remains at least [clear - dot u m] away from the motion [m]. *)
Lemma beside u o m clear : norm u <= 1 -> clear <= dot u o -> clear - dot u m <= norm (sub o m).
Proof.
  intros Hu Ho. pose proof (cauchy u (sub o m)) as C. pose proof (norm_nonneg (sub o m)).
  replace (dot u (sub o m)) with (dot u o - dot u m) in C by (unfold dot, sub; simpl; ring). nra.
Qed.

(** * The cone *)

(* The largest approach of the motion [m] to a place in a cone around the direction [u]; [slant]
   is the sine of the cone's angle. Inside the cone the motion can aim straight at the place. *)
Definition towards (u m : vec) (slant : R) : R :=
  let closing := dot m u in
  let side := norm (sub m (scale closing u)) in
  let cos := sqrt (1 - slant * slant) in
  if Rle_dec (side * cos) (closing * slant) then norm m else closing * cos + side * slant.

Definition unit u := scale (/ norm u) u.

Lemma unit_norm u : 0 < norm u -> norm (unit u) = 1.
Proof.
  intros H. unfold unit. rewrite norm_scale; [field; lra |].
  left. apply Rinv_0_lt_compat; assumption.
Qed.

Lemma unit_dot u : 0 < norm u -> dot (unit u) (unit u) = 1.
Proof. intros H. rewrite <- norm_sq, unit_norm by assumption. ring. Qed.

Lemma unit_scale u : 0 < norm u -> scale (norm u) (unit u) = u.
Proof.
  intros H. unfold unit. set (n := norm u) in *. destruct u as [a b c].
  unfold scale; simpl. f_equal; field; lra.
Qed.

(* A vector's part along [u] and the rest. *)
Lemma rest_sq u w : dot u u = 1 ->
  norm (sub w (scale (dot w u) u)) * norm (sub w (scale (dot w u) u))
    = norm w * norm w - dot w u * dot w u.
Proof.
  intros Hu. rewrite !norm_sq.
  replace (dot (sub w (scale (dot w u) u)) (sub w (scale (dot w u) u)))
    with (dot w w - 2 * (dot w u * dot w u) + dot w u * dot w u * dot u u)
    by (unfold dot, sub, scale; simpl; ring).
  rewrite Hu. ring.
Qed.

Lemma parts_dot u w m : dot u u = 1 ->
  dot w m <= dot w u * dot m u
    + norm (sub w (scale (dot w u) u)) * norm (sub m (scale (dot m u) u)).
Proof.
  intros Hu. pose proof (cauchy (sub w (scale (dot w u) u)) (sub m (scale (dot m u) u))) as C.
  replace (dot (sub w (scale (dot w u) u)) (sub m (scale (dot m u) u)))
    with (dot w m - 2 * (dot w u * dot m u) + dot w u * dot m u * dot u u) in C
    by (unfold dot, sub, scale; simpl; ring).
  rewrite Hu in C. lra.
Qed.

(* A ball with the radius [g] at the distance [d] is seen in a cone with the sine [g / d]. *)
Lemma ball_in_cone u w d g : dot u u = 1 -> 0 <= g < d -> norm (sub w (scale d u)) <= g ->
  sqrt (1 - g / d * (g / d)) * norm w <= dot w u.
Proof.
  intros Hu [Hg Hd] Hw.
  assert (E : norm (sub w (scale d u)) * norm (sub w (scale d u))
    = norm w * norm w - 2 * d * dot w u + d * d).
  { rewrite !norm_sq.
    replace (dot (sub w (scale d u)) (sub w (scale d u)))
      with (dot w w - 2 * d * dot w u + d * d * dot u u) by (unfold dot, sub, scale; simpl; ring).
    rewrite Hu. ring. }
  pose proof (norm_nonneg (sub w (scale d u))) as N1. pose proof (norm_nonneg w) as N2.
  assert (B : norm w * norm w - 2 * d * dot w u + d * d <= g * g) by nra.
  assert (P : 0 <= dot w u) by nra.
  assert (F : d * d * (1 - g / d * (g / d)) = d * d - g * g) by (field; lra).
  assert (C : 0 <= 1 - g / d * (g / d)).
  { apply Rmult_le_reg_l with (d * d); [nra |]. rewrite F. nra. }
  apply square_le; [assumption |].
  replace (sqrt (1 - g / d * (g / d)) * norm w * (sqrt (1 - g / d * (g / d)) * norm w))
    with (sqrt (1 - g / d * (g / d)) * sqrt (1 - g / d * (g / d)) * (norm w * norm w)) by ring.
  rewrite sqrt_sqrt by assumption.
  apply Rmult_le_reg_l with (d * d); [nra |].
  rewrite <- Rmult_assoc, F.
  pose proof (square_nonneg (d * dot w u - (d * d - g * g))).
  assert (0 <= (d * d - g * g) * (g * g - d * d + 2 * d * dot w u - norm w * norm w))
    by (apply Rmult_le_pos; nra). lra.
Qed.

(* The same in numbers: [a], [b] are the parts of a direction in the cone, [k], [s] cosine and
   sine of its edge, [c], [side] the parts of the motion. *)
Lemma cone_edge a b k s c side :
  0 <= b -> 0 <= s -> 0 < k -> a * a + b * b = 1 -> k * k + s * s = 1 -> k <= a ->
  0 <= side -> c * s <= side * k -> a * c + b * side <= c * k + side * s.
Proof.
  intros Hb Hs Hk Ha Hks Hka Hside H.
  assert (B : b <= s) by (apply square_le; nra).
  destruct (Rle_dec c 0) as [C | C].
  - assert (0 <= (a - k) * - c) by (apply Rmult_le_pos; lra).
    assert (0 <= (s - b) * side) by (apply Rmult_le_pos; lra). lra.
  - assert (U : k * a + s * b <= 1).
    { pose proof (square_nonneg (k - a)). pose proof (square_nonneg (s - b)). lra. }
    assert (T : k * (c * (a - k)) <= k * (side * (s - b))).
    { assert (0 <= (side * k - c * s) * (s - b)) by (apply Rmult_le_pos; lra).
      assert (0 <= c * (1 - (k * a + s * b))) by (apply Rmult_le_pos; lra).
      assert (c * (k * k + s * s) = c) by (rewrite Hks; ring). nra. }
    apply Rmult_le_reg_l in T; lra.
Qed.

Lemma slant_range g d : 0 <= g < d -> 0 <= g / d < 1.
Proof.
  intros [Hg Hd]. split.
  - apply Rmult_le_pos; [lra |]. left. apply Rinv_0_lt_compat. lra.
  - apply Rmult_lt_reg_r with d; [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

Lemma cos_sin s : 0 <= s < 1 ->
  0 < sqrt (1 - s * s) /\ sqrt (1 - s * s) * sqrt (1 - s * s) + s * s = 1.
Proof.
  intros H. split; [apply sqrt_lt_R0; nra |]. rewrite sqrt_sqrt by nra. ring.
Qed.

(* [u]: direction of the ball's centre, [d]: its distance, [g]: its radius, [w]: where the other
   robot is. *)
Theorem cone u w m d g : dot u u = 1 -> 0 <= g < d -> norm (sub w (scale d u)) <= g ->
  dot w m <= norm w * towards u m (g / d).
Proof.
  intros Hu Hg Hw. unfold towards. set (k := sqrt (1 - g / d * (g / d))). set (s := g / d) in *.
  set (c := dot m u). set (side := norm (sub m (scale c u))).
  destruct (Rle_dec (side * k) (c * s)) as [I | I]; [apply cauchy |].
  pose proof (ball_in_cone u w d g Hu Hg Hw) as B. fold s k in B.
  destruct (cos_sin s (slant_range g d Hg)) as [K KS]. fold k in K, KS.
  pose proof (norm_nonneg w) as N.
  destruct (Req_dec (norm w) 0) as [Z | Z].
  { pose proof (cauchy w m) as C. rewrite Z in *. lra. }
  pose proof (parts_dot u w m Hu) as P. fold c side in P.
  pose proof (rest_sq u w Hu) as Q. set (q := norm (sub w (scale (dot w u) u))) in *.
  assert (Nq : 0 <= q) by apply norm_nonneg.
  assert (W : 0 < norm w) by lra.
  assert (Iw : 0 < / norm w) by (apply Rinv_0_lt_compat; assumption).
  assert (E : (dot w u / norm w) * c + (q / norm w) * side <= c * k + side * s).
  { apply cone_edge; try lra.
    - apply Rmult_le_pos; lra.
    - apply (slant_range g d Hg).
    - replace (dot w u / norm w * (dot w u / norm w) + q / norm w * (q / norm w))
        with ((dot w u * dot w u + q * q) / (norm w * norm w)) by (field; lra).
      rewrite Q. field. lra.
    - apply Rmult_le_reg_r with (norm w); [assumption |].
      replace (dot w u / norm w * norm w) with (dot w u) by (field; lra). assumption.
    - apply norm_nonneg. }
  eapply Rle_trans; [exact P |].
  replace (dot w u * c + q * side) with (norm w * (dot w u / norm w * c + q / norm w * side))
    by (field; lra).
  apply Rmult_le_compat_l; lra.
Qed.

(* Outside the cone the bound is attained: at the place where the cone touches the ball. [n] is
   the direction of the motion beside [u]. *)
Theorem cone_is_tight u n c side d g : dot u u = 1 -> dot n n = 1 -> dot u n = 0 -> 0 <= g < d ->
  exists w, 0 < norm w /\ norm (sub w (scale d u)) <= g /\
    approach w (add (scale c u) (scale side n))
      = c * sqrt (1 - g / d * (g / d)) + side * (g / d).
Proof.
  intros Hu Hn Hun Hg. destruct (cos_sin (g / d) (slant_range g d Hg)) as [K KS].
  set (k := sqrt (1 - g / d * (g / d))) in *. set (s := g / d) in *.
  assert (Sd : s * d = g) by (unfold s; field; lra).
  set (w := scale (d * k) (add (scale k u) (scale s n))).
  assert (N : norm w = d * k).
  { unfold w. rewrite norm_scale by nra.
    rewrite (norm_is _ 1); [ring | lra |].
    replace (dot (add (scale k u) (scale s n)) (add (scale k u) (scale s n)))
      with (k * k * dot u u + 2 * k * s * dot u n + s * s * dot n n)
      by (unfold dot, add, scale; simpl; ring).
    rewrite Hu, Hn, Hun. lra. }
  exists w. split; [rewrite N; nra |]. split.
  - apply norm_le; [lra |].
    replace (dot (sub w (scale d u)) (sub w (scale d u)))
      with (norm w * norm w - 2 * d * dot w u + d * d * dot u u)
      by (rewrite norm_sq; unfold dot, sub, scale; simpl; ring).
    replace (dot w u) with (d * k * (k * dot u u + s * dot u n))
      by (unfold w, dot, add, scale; simpl; ring).
    rewrite N, Hu, Hun, <- Sd. nra.
  - unfold approach. rewrite N.
    replace (dot w (add (scale c u) (scale side n)))
      with (d * k * (k * (c * dot u u + side * dot u n) + s * (c * dot u n + side * dot n n)))
      by (unfold w, dot, add, scale; simpl; ring).
    rewrite Hu, Hn, Hun. field. split; lra.
Qed.

(** * A narrow cone *)

(* [tilt]: how far the direction may be off, as the length of a difference of unit vectors. *)
Definition narrow (u m : vec) (tilt : R) : R := dot m u + norm m * tilt.

Lemma narrow_bound u w m tilt : 0 < norm w -> dist (unit w) u <= tilt ->
  approach w m <= narrow u m tilt.
Proof.
  intros Hw Ht. unfold approach, narrow.
  replace (dot w m / norm w) with (dot m u + dot m (sub (unit w) u))
    by (unfold unit, dot, sub, scale; simpl; field; lra).
  pose proof (cauchy m (sub (unit w) u)). pose proof (norm_nonneg m). unfold dist in Ht. nra.
Qed.

Lemma tilt_sq u w d : dot u u = 1 -> 0 < norm w ->
  norm w * d * (dist (unit w) u * dist (unit w) u)
    = norm (sub w (scale d u)) * norm (sub w (scale d u)) - (norm w - d) * (norm w - d).
Proof.
  intros Hu Hw. unfold dist. rewrite !norm_sq.
  replace (dot (sub (unit w) u) (sub (unit w) u))
    with (dot (unit w) (unit w) + dot u u - 2 * (dot w u / norm w))
    by (unfold unit, dot, sub, scale; simpl; field; lra).
  rewrite unit_dot by assumption.
  replace (dot (sub w (scale d u)) (sub w (scale d u)))
    with (norm w * norm w - 2 * d * dot w u + d * d * dot u u)
    by (rewrite norm_sq; unfold dot, sub, scale; simpl; ring).
  rewrite Hu. field. lra.
Qed.

(* The place is known up to [e] at the distance [d]. *)
Lemma tilt_bound u w d e : dot u u = 1 -> 0 <= e < d -> norm (sub w (scale d u)) <= e ->
  0 < norm w /\ dist (unit w) u <= e / (d - e / 2).
Proof.
  intros Hu [He Hd] Hw.
  assert (Nu : norm u = 1) by (apply norm_is; lra).
  assert (L : d - e <= norm w).
  { pose proof (norm_dist (scale d u) w) as T. rewrite norm_scale, Nu in T by lra.
    rewrite dist_sym in T. unfold dist in T. lra. }
  split; [lra |].
  assert (W : 0 < norm w) by lra.
  pose proof (tilt_sq u w d Hu W) as T. pose proof (norm_nonneg (sub w (scale d u))) as N.
  set (a := dist (unit w) u) in *. set (f := norm (sub w (scale d u))) in *. set (l := norm w) in *.
  assert (A : 0 <= a) by apply norm_nonneg.
  assert (B : a * (l + d) <= 2 * e).
  { apply square_le; [lra |].
    assert (P : 0 <= l * d * (a * a))
      by (apply Rmult_le_pos; [apply Rmult_le_pos; lra | apply square_nonneg]).
    assert (F : f * f <= e * e) by (apply Rmult_le_compat; lra).
    apply Rmult_le_reg_l with (l * d); [nra |].
    replace (l * d * (a * (l + d) * (a * (l + d)))) with (l * d * (a * a) * ((l + d) * (l + d)))
      by ring.
    rewrite T.
    assert (E : e * e <= (l + d) * (l + d)) by nra.
    assert (0 <= (l - d) * (l - d) * ((l + d) * (l + d) - e * e))
      by (apply Rmult_le_pos; [apply square_nonneg | lra]).
    assert (0 <= (e * e - f * f) * ((l + d) * (l + d)))
      by (apply Rmult_le_pos; [lra | apply square_nonneg]). nra. }
  apply Rmult_le_reg_r with (d - e / 2); [lra |].
  replace (e / (d - e / 2) * (d - e / 2)) with e by (field; lra).
  assert (0 <= a * (l - (d - e))) by (apply Rmult_le_pos; lra). lra.
Qed.

(** * The sine alone *)

(* The bound [closing + side * slant] is wrong for a robot that recedes: it is 0 here, but the
   robot approaches. *)
Theorem sine_alone_is_too_weak : exists u w m d g,
  dot u u = 1 /\ 0 <= g < d /\ norm (sub w (scale d u)) <= g /\
  dot m u + norm (sub m (scale (dot m u) u)) * (g / d) = 0 /\ 0 < approach w m.
Proof.
  exists (V 1 0 0), (V (16/5) (12/5) 0), (V (-1) (5/3) 0), 5, 3.
  assert (N : norm (V (16/5) (12/5) 0) = 4) by (apply norm_is; unfold dot; simpl; lra).
  repeat split; try lra.
  - unfold dot; simpl; lra.
  - apply norm_le; unfold dot, sub, scale; simpl; lra.
  - rewrite (norm_is _ (5/3)); [unfold dot; simpl; lra | lra | unfold dot, sub, scale; simpl; lra].
  - unfold approach. rewrite N. unfold dot; simpl; lra.
Qed.
