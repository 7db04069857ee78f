/* energy.inl - the energy balance of an event step: input by the ground, dissipated and stored energy.
 *
 * Included by exact.inl alone, once per lane count; used only by simulations with TRAIT_ACCOUNTED.
 *
 * Included by exact.inl after contact_map.inl. */

/* Adds the work of a step, per mass of the left body [m2/s2].
 *
 * Given    s       the step's series;  time: the fraction of the step that was taken
 * Returns  g       work_in: by the ground; work_gap + work_low: by the dashpots, on the laws' springs and on the contact,
 *                  less that by the ground, summed with the rounding of each addition carried on (Kahan 1965);
 *                  work_top: the largest work_in or kinetic energy so far
 */
static void energy_add(struct lanes *g, const struct series *s, vd time, struct scope scope)
{
	vd in = vsplat(0), out = in, top = in, dt = g->dt;
	const vd mass[2] = {vsplat(1), g->right_mass};
	for (int j = 0; j < POUND_GAUSS; j++) {
		double node = j < POUND_GAUSS / 2 ? -POUND_GAUSS_NODE[j] : POUND_GAUSS_NODE[j - POUND_GAUSS / 2];
		vd weight = vsplat(0.5 * POUND_GAUSS_WEIGHT[j % (POUND_GAUSS / 2)]);
		vd t = vsplat(0.5 + 0.5 * node) * time;
		vd ground = vfma(g->slope, t * dt, g->ground), moving = vsplat(0);
		for (int i = 0; i < (scope.paired ? 2 : 1); i++) {
			struct kinematics at = kinematics_at(&s->body[i].u, s->order, t);
			vd u = at.u, v = at.v / dt;
			vd spring = vfma(g->body[i].stiffness, u, g->body[i].offset);
			in = vfma(weight * mass[i] * v, -g->body[i].drive * ground, in);
			out = vfma(weight * mass[i] * v, vfma(g->body[i].damping, v, spring), out);
			moving = vfma(0.5 * mass[i] * v, v, moving);
		}
		// the largest energy may occur inside the step, if the ground takes it back before the end
		top = vmax(top, moving);
		if (!scope.touching)
			continue;
		struct kinematics at = kinematics_at(&s->overlap.u, s->order, t);
		vd p = at.u, q = at.v / dt;
		out = vfma(weight * q, vfma(g->contact_stiffness, p, g->contact_damping * q), out);
	}
	vd elapsed = time * dt;
	g->work_in = vfma(elapsed, in, g->work_in);
	vd gap = vfma(elapsed, out - in, g->work_low), sum = g->work_gap + gap;
	g->work_low = gap - (sum - g->work_gap);
	g->work_gap = sum;
	vd moving = vsplat(0);
	for (int i = 0; i < (scope.paired ? 2 : 1); i++) {
		vd v = kinematics_at(&s->body[i].u, s->order, time).v / dt;
		moving = vfma(0.5 * mass[i] * v, v, moving);
	}
	g->work_top = vmax(g->work_top, vmax(vabs(g->work_in), vmax(top, moving)));
}
