/* oscillator_maps.inl - oscillators on a floor in free motion, by maps of whole samples.
 *
 * The segments of a sample differ only in the state numbers of the floor at their starts, so that the map of the first one serves
 * all, and the map of the sample follows from it.
 *
 * Included by oscillator_bank.inl before the bank, once per lane count. */

/* Appends a segment to a passage, by the increments of a unit displacement and a unit velocity. */
LANE_INLINE void passage_append(struct passage *all, const struct passage *m, int i)
{
	const vd z = 1.0 + all->zz[i], v = 1.0 + all->vv[i];
	const vd zz = vfma(m->zz[i], z, m->zv[i] * all->vz[i]), vz = vfma(m->vz[i], z, m->vv[i] * all->vz[i]);
	const vd zv = vfma(m->zv[i], v, m->zz[i] * all->zv[i]), vv = vfma(m->vv[i], v, m->vz[i] * all->zv[i]);
	all->zz[i] = all->zz[i] + zz, all->vz[i] = all->vz[i] + vz;
	all->zv[i] = all->zv[i] + zv, all->vv[i] = all->vv[i] + vv;
}

/* The floor's state numbers a segment later.
 *
 *   r' = h k v     v' = -h (c v + r + forcing)     h: the length of the segment
 */
static void floor_map_fill(struct floor_map *map, double k, double c, double h, int n)
{
	const double hk = h * k, hc = h * c;
	map->share = 1.0 / n;
	for (int state = 0; state < 4; state++) {
		double r[TERMS + 1], v[TERMS + 1];
		r[0] = state == 0, v[0] = state == 1;
		for (int o = 0; o < TERMS; o++) {
			const double force = o == 0 ? h * (state == 2) : o == 1 ? h * (state == 3) * map->share : 0;
			r[o + 1] = hk * v[o];
			v[o + 1] = -(hc * v[o] + (h * r[o] + force));
		}
		map->r[state] = map->v[state] = 0;
		for (int o = TERMS; o >= 0; o--) {
			map->r[state] += r[o] * POUND_FACTOR[o];
			map->v[state] += v[o] * POUND_FACTOR[o];
		}
	}
}

/* Moves the state numbers of a floor to the next segment. */
LANE_INLINE void floor_move(const struct floor_map *map, double state[4])
{
	double r = 0, v = 0;
	for (int k = 0; k < 4; k++) {
		r += map->r[k] * state[k];
		v += map->v[k] * state[k];
	}
	state[0] = r;
	state[1] = v;
	state[2] += map->share * state[3];
}

/* Increments of oscillators by the motion of the floor. */
LANE_INLINE void drive_map_take(const struct drive_map *map, const double state[4], int i, vd *z, vd *v)
{
	*z = *v = vsplat(0);
#pragma GCC unroll 4
	for (int k = 0; k < 4; k++) {
		*z = vfma(map->z[k][i], vsplat(state[k]), *z);
		*v = vfma(map->v[k][i], vsplat(state[k]), *v);
	}
}

/* The passages of a sample without a drive, and of its segments. */
static void passages_fill(struct maps *maps)
{
	const struct force none = {.terms = TERMS};
	struct response response;
	vd z[G], y[G];
	force_pass(&maps->segment, &none, 0, z, y, &response);
	passage_fill(&maps->of_segment, &response, &maps->segment);
	maps->of_whole = maps->of_segment;
	for (int j = 1; j < maps->segment.n; j++)
		for (int i = 0; i < G; i++)
			passage_append(&maps->of_whole, &maps->of_segment, i);
}

/* Increments of oscillators on a floor of one stiffness: over the first segment of a sample, and over the whole sample, in which
 * the others are segments that begin with other state numbers.
 */
static void drive_map_fill(struct maps *maps, int m, const struct pound_bank *bank,
                           const struct pound_bank_input *input)
{
	const struct segment *p = &maps->segment;
	const int order = input->stretch->order;
	const double stiffness = input->stretch->stiffness[m], per_step = 1 / p->step;
	struct drive_map *first = &maps->drive_of_segment[m], *whole = &maps->drive_of_whole[m];
	struct floor_map *floor = &maps->floor_of_segment[m];
	floor_map_fill(floor, stiffness, input->damping, p->step, p->n);
	for (int state = 0; state < 4; state++) {
		const double unit[4] = {state == 0, state == 1, state == 2, state == 3};
		double a[POUND_FLOOR_ROOM];
		struct force force;
		struct response response;
		pound_floor_free_motion(unit, stiffness, input->damping, input->time_step, order, a);
		const struct drive drive = {a, order, TERMS};
		force_fill(&force, bank->powers, &drive, p, 0);
		force_pass(p, &force, order, first->z[state], first->v[state], &response);
		for (int i = 0; i < G; i++)
			first->v[state][i] = first->v[state][i] * per_step;
	}
	for (int state = 0; state < 4; state++) {
		double now[4] = {state == 0, state == 1, state == 2, state == 3};
		for (int i = 0; i < G; i++)
			whole->z[state][i] = whole->v[state][i] = vsplat(0);
		for (int j = 0; j < p->n; j++) {
			for (int i = 0; i < G; i++) {
				vd z, v;
				drive_map_take(first, now, i, &z, &v);
				passage_take(&maps->of_segment, i, &whole->z[state][i], &whole->v[state][i], z, v);
			}
			floor_move(floor, now);
		}
	}
}

/* All maps of a sample, for every stiffness of a stretch. */
static void maps_fill(struct maps *maps, const struct pound_bank *bank, const struct group *g,
                      const struct pound_bank_input *input, int segments)
{
	const double h = input->time_step;
	segment_init(&maps->whole, g, h, 1);
	segment_init(&maps->segment, g, h, segments);
	passages_fill(maps);
	for (int m = 0; m < input->stretch->n_maps; m++)
		drive_map_fill(maps, m, bank, input);
	for (int i = 0; i < G; i++) {
		const vd zero = vsplat(0), per = g->per_omega[i], per2 = per * per;
		const vm fast = vless(vsplat(1), g->omega[i] * h);
		maps->on_start[i] = vselect(fast, per2, zero);
		maps->on_rate[i] = vselect(fast, per2 * per * (1 / h), zero);
		maps->on_bound[0][i] = vselect(fast, per2, per * h);
		maps->on_bound[1][i] = vselect(fast, per2 * (2 * g->damping), zero);
		maps->on_bound[2][i] = maps->on_rate[i];
		maps->miss_of_whole[i] = cubic_error_of(&maps->whole, g, i);
	}
}

/* Lanes in which |z| may have a new maximum inside a whole sample h of free motion.
 *
 * Given    a  the drive: bounds A, A', A'', coefficients a and its rate at the start, by the elapsed fraction of the sample
 *
 * Slow oscillators, w h <= 1: as in risk_of_piece.  Fast ones follow the floor: with y = z + a/w^2
 *   y'' + 2 xi w y' + w^2 y = a''/w^2 + 2 xi a'/w     E of y grows by at most A''/(h w^3) + 2 xi A'/w^2, |z| <= E + A/w^2
 */
LANE_INLINE vm risk_of_sample(const struct maps *m, const struct group *g, const struct state *s, int i,
                              const struct pound_polynomial *a)
{
	const vd z = vfma(m->on_start[i], vsplat(a->c[0]), s->z[i]);
	const vd v = vfma(m->on_rate[i], vsplat(a->c[1]), s->v[i] * g->per_omega[i]);
	vd left = s->top[i];
	for (int k = 0; k < 3; k++)
		left = vfma(m->on_bound[k][i], vsplat(-a->bound[k]), left);
	return vless(left * vabs(left), vfma(z, z, vfma(v, v, vsplat(SQUARES_LEAST))));
}

/* the contact's drive in free motion */
static const struct pound_polynomial none = {{0}, {0}};

/* one vector of a group over a whole sample */
struct sample_place {
	const struct pound_bank *bank;
	const struct pound_bank_input *input;
	const struct pound_floor_piece *piece;
	const struct maps *maps;
	const struct group *group;
	int i;
};

/* The largest |z| of a sample, by its segments, in the lanes of risk; else top. */
LANE_SHARED vd sample_top(const struct sample_place *at, enum pound_drive drive, vm risk, vd top)
{
	const int i = at->i;
	const struct maps *maps = at->maps;
	const struct pound_floor_stretch *stretch = at->input->stretch;
	const struct state *s = &at->group->s[drive];
	const bool driven = drive == POUND_DRIVE_FLOOR;
	const int map = at->piece->map;
	double room[POUND_FLOOR_ROOM];
	const double *bound = driven ? at->piece->floor.bound : none.bound;
	struct force force;
	struct stage stage = {&maps->segment, i, bound, s->z[i], s->v[i], s->z[i], s->v[i]};
	const struct cubic_error miss = cubic_error_of(&maps->segment, at->group, i);
	double state[4];
	for (int k = 0; k < 4; k++)
		state[k] = at->piece->state[k];
	for (int j = 0; j < maps->segment.n; j++) {
		vd z = vsplat(0), v = vsplat(0);
		stage.z = stage.z1, stage.v = stage.v1;
		if (driven)
			drive_map_take(&maps->drive_of_segment[map], state, i, &z, &v);
		passage_take(&maps->of_segment, i, &stage.z1, &stage.v1, z, v);
		top = vselect(risk, vmax(top, vabs(stage.z1)), top);
		const vm inside = risk_of_segment(&stage, &miss, top) & risk;
		if (vany(inside)) {
			const int order = driven ? stretch->order : -1;
			pound_floor_free_motion(state, stretch->stiffness[map], at->input->damping, at->piece->step,
			                        order, room);
			const struct drive made = drive_of(room, order, &maps->segment, bound[0]);
			force_fill(&force, at->bank->powers, &made, &maps->segment, 0);
			top = segment_top(&stage, &force, inside, top);
		}
		floor_move(&maps->floor_of_segment[map], state);
	}
	return top;
}

/* Integrates a group over a whole sample by maps; the contact's drive is 0.
 *
 * A new largest displacement is excluded by the cubic through the ends of the sample if all oscillators are slow; else by
 * risk_of_sample, and where this does not suffice, by the cubic.
 */
LANE_INLINE void sample_move(struct sample_place *at, enum pound_drive drive, struct group *g)
{
	const bool driven = drive == POUND_DRIVE_FLOOR;
	const struct pound_floor_piece *piece = at->piece;
	const struct pound_polynomial *a = driven ? &piece->floor : &none;
	const struct drive_map *map = &at->maps->drive_of_whole[piece->map];
	struct state *s = &g->s[drive];
	for (int i = 0; i < G; i++) {
		vd z = vsplat(0), v = vsplat(0);
		if (driven)
			drive_map_take(map, piece->state, i, &z, &v);
		struct stage stage = {&at->maps->whole, i, a->bound, s->z[i], s->v[i], s->z[i], s->v[i]};
		passage_take(&at->maps->of_whole, i, &stage.z1, &stage.v1, z, v);
		vm risk = g->slow ? vmask((1u << W) - 1) : risk_of_sample(at->maps, g, s, i, a);
		if (g->slow || __builtin_expect(vany(risk), 0)) {
			s->top[i] = vselect(risk, vmax(s->top[i], vabs(stage.z1)), s->top[i]);
			risk = risk & risk_of_segment(&stage, &at->maps->miss_of_whole[i], s->top[i]);
			if (__builtin_expect(vany(risk), 0)) {
				at->i = i;
				s->top[i] = sample_top(at, drive, risk, s->top[i]);
			}
		}
		s->z[i] = stage.z1;
		s->v[i] = stage.v1;
	}
}
