"""Home-made names that the field has terms for: tools/check_structure reports them in the sources."""

import re

from . import sources

# The name: the term, and the folder or folders, or beginnings of paths, that the rule is for where the word is a good one elsewhere.
RETIRED = {
    "find_rates": ("compute_rates", ""),
    "find_jumps": ("compute_jumps", ""),
    "find_pressures": ("compute_pressures", ""),
    "find_surface": ("update_geometry", ""),
    "take_centres": ("sample_level_set_at_centres", ""),
    "gripping_": ("no_slip_", ""),
    "grips": ("no_slip", ""),
    "StepParts": ("StepContext", ""),
    "ViscousParts": ("ViscousContext", "src/sph"),
    "ComplementarityParts": ("ComplementarityContext", ""),
    "PressureScene": ("PressureContext", ""),
    "StrainScene": ("StrainContext", ""),
    "Departures": ("DepartureCounts", ""),
    "gather_fluid": ("make_views", ""),
    "gather_sum": ("sparse_dot", ""),
    "Gathering": ("RankAgglomeration", ""),
    "Images": ("MirrorParticles", "src/grid"),
    "IntLanes": ("SimdInt", ""),
    "Lanes": ("SimdDouble", ("kokkos", "src/grid", "src/solve", "src/sph")),
    "Quad": ("Double4", ""),
    "Four": ("Float4", ""),
    "Tile": ("Float4x4", ""),
    "spread": ("broadcast_elements", "kokkos"),
    "repeat": ("broadcast_row", "kokkos"),
    "only_last": ("keep_last_row", ""),
    "write_ints": ("compress_store", ""),
    "write_lanes": ("compress_store", ""),
    "bits_of": ("to_bitmask", ""),
    "first_lanes": ("tail_mask", ""),
    "recut": ("repartition", ""),
    "rebalance_above": ("max_load_imbalance", ""),
    "Slices": ("ExchangePlan", ""),
    "spare": ("padding", "kokkos"),
    "SharedRows": ("SharedNodeSum", ""),
    "Voice": ("LogOutput", ""),
    "KeyNumbers": ("KeyIndexMap", ""),
    "standard": ("default_text", "src/base"),
    "allow_plane_vectors": ("allow_2d_vectors", ""),
    "FaceKind": ("BoundaryKind", ""),
    "around_bodies": ("subtract_bodies", ""),
    "lost_limit": ("max_lost_fraction", ""),
    "infinite_viscosity": ("infinite_shear_viscosity", ""),
    "least_shear_rate": ("min_shear_rate", ""),
    "FlowCurve": ("ViscosityModel", ""),
    "ShearLaw": ("ViscosityModelKind", ""),
    "LayerSource": ("InletEmitter", ""),
    "held_layers": ("buffer_layers", ""),
    "make_plugs": ("make_inlet_bodies", ""),
    "plug_layers": ("inlet_body_layers", ""),
    "conveys": ("surface_velocity_only", ""),
    "poured_particles": ("inflow_particles", ""),
    "poured_viscosity": ("inflow_viscosity", ""),
    "Settled": ("InsetPoint", ""),
    "settle": ("project_to_inset", "src/scene"),
    "EvenLayer": ("PoissonDiskLayer", ""),
    "Revolved": ("SurfaceOfRevolution", ""),
    "make_cut": ("make_cross_section", ""),
    "TriangleTree": ("TriangleBvh", ""),
    "thinnest": ("thickness_p01", ""),
    "strike": ("apply_impulses", ""),
    "open_ledger": ("begin_load_sums", ""),
    "rub": ("solve_friction", ""),
    "Mobility": ("ConstrainedInverseMass", ""),
    "JointRow": ("ConstraintRow", ""),
    "joint_gap": ("constraint_error", ""),
    "Movable": ("SolverBody", ""),
    "Probe": ("ContactSample", "src/rigid"),
    "lever": ("length_scale", "src/rigid"),
    "MadeRows": ("CoarseRows", ""),
    "Felt": ("ModeEntries", ""),
    "GridRule": ("Rediscretisation", ""),
    "multilevel_grids": ("multilevel_rediscretised", ""),
    "rows_per_rank": ("min_rows_per_rank", ""),
    "secure_sweeps": ("set_l1_diagonal", ""),
    "secured_": ("l1_diagonal_", ""),
    "border_sweeps": ("interface_sweeps", ""),
    "border_": ("interface_", ""),
    "RigidBorder": ("BorderedBodies", ""),
    "sweep_down": ("sweep_forward", ""),
    "sweep_up": ("sweep_backward", ""),
    "RigidLinks": ("RigidBodyProlongation", ""),
    "Separation": ("DisconnectedSplit", "src/solve"),
    "small_box": ("small_aggregate_width", ""),
    "dense_rows": ("max_coarse_size", ""),
    "CellKey": ("MortonKey", ""),
    "halvings": ("coarsening_levels", ""),
    "ComponentSplit": ("FieldSplitPreconditioner", ""),
    "near_kernel": ("near_null_space", ""),
    "set_addition": ("set_matrix_free_term", ""),
    "shadows": ("shadow_space_dimension", "src/solve"),
    "most_vain_cycles": ("max_stagnant_cycles", ""),
    "far_down": ("deep_residual_drop", ""),
    "worth_keeping": ("best_iterate_ratio", ""),
    "spoiled": ("restart_threshold", ""),
    "worthwhile": ("min_reduction", ""),
    "BoundedGoal": ("StoppingTest", ""),
    "face_wet": ("face_liquid_clipped", ""),
    "cell_wet": ("cell_liquid_clipped", ""),
    "least_wet": ("min_liquid_fraction", ""),
    "wet_share": ("theta", ""),
    "least_distance": ("min_theta", ""),
    "least_opening": ("min_face_area_fraction", ""),
    "least_gap": ("min_fluid_fraction", ""),
    "normal_layer": ("no_penetration_layer", ""),
    "solves_together": ("solves_monolithic", ""),
    "continue_changes": ("extrapolate_increment", ""),
    "Continued": ("Extrapolated", ""),
    "continue_velocity": ("extrapolate_velocity", ""),
    "turn_along_solids": ("enforce_wall_velocity", ""),
    "WallGrip": ("WallCondition", ""),
    "ViscousSpread": ("DiffusionNumber", ""),
    "over_half_a_cell": ("diffusion_number", ""),
    "FaceMarks": ("FaceValidity", ""),
    "mark_solved": ("mark_valid_faces", ""),
    "Contraction": ("DensityRelaxation", ""),
    "contracts": ("relaxes_density", ""),
    "slack": ("dead_band", "src/grid"),
    "crowding_": ("max_density_error_", ""),
    "tense": ("SurfaceTension::include", ""),
    "relaxed": ("SurfaceTension::omit", "src/grid"),
    "unbalanced": ("incompatible_fraction", ""),
    "lifted": ("unpinned", ""),
    "Anchoring": ("PressurePinning", ""),
    "anchored": ("pinned", "src/sph"),
    "to_surface": ("dirichlet_diagonal", ""),
    "idle_face": ("inactive_face", ""),
    "free_face": ("unknown_face", ""),
    "held_face": ("prescribed_face", ""),
    "cast_roles": ("classify_faces", ""),
    "pulled_": ("stress_coupling_", ""),
    "slipped_": ("slip_coupling_", ""),
    "feels_": ("has_moving_bodies_", ""),
    "lean": ("slip_interpolation_weight", ""),
    "pressed": ("pressure_faces", "src/grid"),
    "pushed": ("effective_area_fraction", "src/grid"),
    "softness": ("cfm_epsilon", ""),
    "compute_loads": ("compute_pressure_over_density2", ""),
    "own_load": ("own_pressure_weight", ""),
    "write_places": ("pack_positions", ""),
    "write_motions": ("pack_velocities", ""),
    "pack_motion": ("pack_velocity", ""),
    "multiply_nearly": ("multiply_single_precision", ""),
    "follow_directions": ("iterate_cg", ""),
    "keep_change": ("store_increment", ""),
    "ground": ("inertia_and_wall_diagonal", "src/sph"),
    "smeared_share": ("smoothed_viscous_coefficient", ""),
    "give_way": ("strongly_coupled", ""),
    "Answer": ("BodyCoupling", "src/sph"),
    "one_step_late": ("weak", ""),
    "body_coupling": ("coupling", ""),
    "BodyResponse": ("RigidCouplingTerm", ""),
    "movers_": ("body_unknowns_", ""),
    "wall_cover": ("wall_laplacian_factor", ""),
    "wall_push": ("wall_pressure_factor", ""),
    "wall_grip": ("wall_viscous_factor", ""),
    "wall_wetting": ("wall_kernel_sum", ""),
    "rest_gap": ("equilibrium_wall_distance", ""),
    "solid_scale": ("boundary_volume_factor", ""),
    "stirred": ("disordered_volume_factor", ""),
    "measure_lattice": ("compute_lattice_sums", ""),
    "measure_wall": ("compute_wall_sums", ""),
    "Mixture": ("ImmiscibleLiquids", ""),
    "laminar": ("pair_viscosity", ""),
    "colliding": ("pair_artificial_viscosity", ""),
    "conductance": ("inverse_density", ""),
    "recovery": ("relaxation_time", "src/sph/model/immiscible_liquids"),
    "checkerboard_damping": ("hourglass_coefficient", ""),
    "DensityCorrection": ("OrthominCorrection", ""),
    "printed": ("as_published", "src/sph"),
    "rheology_solves": ("max_picard_iterations", ""),
    "rheology_residual": ("picard_residual", ""),
    "LoadPoints": ("MomentReferencePoints", ""),
    "JointParticles": ("CoupledParticles", ""),
    "assemble_joint": ("assemble_with_solids", ""),
    "turns_": ("conserves_torque_", ""),
    "range_of": ("range_projector", "src/sph"),
    "invert_above": ("truncated_pseudo_inverse", ""),
    "least_spread": ("min_moment_eigenvalue", ""),
    "butterflies": ("walsh_hadamard", ""),
    "corner_shares": ("trilinear_weights", ""),
    "hand_down": ("coarsen_masses", ""),
    "mild": ("coarsening_limit", ""),
    "Members": ("CellParticles", "src/sph"),
    "end_together": ("run_collectively", ""),
    "patience": ("timeout", ""),
    "StepFigures": ("StepDiagnostics", ""),
    "BenchFigures": ("BenchResults", ""),
    "body_notes": ("body_warnings", ""),
    "Plumb": ("HeightGauge", ""),
    "clarity": ("attenuation_length", ""),
    "Lamp": ("DirectionalLight", ""),
    "melt": ("screen_space_surface", ""),
}

# Words with several meanings, which are no part of a name: the terms, one for each meaning.
AMBIGUOUS = {
    ("place", "places", "placed", "placement", "placements"):
        "index (array), position [m], column (halo), slot, location (file:line) or pose",
    ("share", "shares"): "fraction, ratio, weight or coefficient",
    ("reach", "reaches", "reached", "reachable"): "halo_width, bounding_radius, support_radius or cutoff",
    ("hold", "holds", "held"): "prescribe (velocity), pin (pressure), constrain (degree of freedom) or contain",
    ("grip", "grips", "gripping"): "no_slip or wall_force",
}
# Names of the standard library, MPI and PETSc that have them.
FOREIGN = {"holds_alternative", "MPI_IN_PLACE", "VecPlaceArray"}

NAME = re.compile(r"[A-Za-z_]\w*")
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")  # of snake_case, CapWords and UPPER_CASE

# Words of comments and documents: the term.
PHRASES = {
    "thin liquids": "low-viscosity liquids, or under-resolved films",
    "stiff liquid": "high-viscosity liquid",
    "out of order": "disordered",
    "on the mean": "on average",
    "in the plane": "in 2D",
    "in space": "in 3D",
    "plane scenes": "2D scenes",
    "held particles": "buffer particles",
    "cuts anew": "repartitions",
    "correction of places": "position correction",
    "closed parts": "enclosed liquid",
    "Chabat": "Chabard",
}

# Names that scene files may still have, and their present ones.
EARLIER_KEYS = "src/scene/renamed_keys.cpp"


def pattern(names):
    """Whole words; the longest first, so that no name hides in another."""
    words = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True))
    return re.compile(rf"(?<!\w)(?:{words})(?!\w)")


def names_in(text, path, names):
    """Pairs (line, name) of those of the names that code or a string of a source has; path is relative to the tree's root."""
    if path == EARLIER_KEYS:
        return []
    found = pattern(names)
    hits = ((number, hit[0]) for number, line in enumerate(sources.code(text).splitlines(), 1) for hit in found.finditer(line))
    return [(number, name) for number, name in hits if path.startswith(RETIRED[name][1])]


def ambiguous_names_in(text):
    """Triples (line, name, terms) of the names in code of which a word is one of AMBIGUOUS; strings are not looked at."""
    terms = {word: terms for words, terms in AMBIGUOUS.items() for word in words}
    hits = ((number, hit[0]) for number, line in enumerate(sources.code(text, strings=False).splitlines(), 1) for hit in NAME.finditer(line))
    found = []
    for number, name in hits:
        word = next((part.lower() for part in PART.findall(name) if part.lower() in terms), None)
        if word and name not in FOREIGN:
            found.append((number, name, terms[word]))
    return found


def uses(root, names):
    """file:line: name of each use in the sources."""
    found = []
    for path in sources.sources(root):
        where = path.relative_to(root).as_posix()
        found += [f"{where}:{number}: {name}, {RETIRED[name][0]}" for number, name in names_in(path.read_text(), where, names)]
    return found


def phrases(root):
    """file:line: phrase of each use in comments of the sources and in the documents beside them."""
    words, found = pattern(PHRASES), []
    for path in sources.sources(root) + sources.documents(root):
        text = path.read_text()
        lines = sources.comment_text(text) if path.suffix in sources.SUFFIXES else enumerate(text.splitlines(), 1)
        found += [f"{path.relative_to(root)}:{number}: {hit[0]}, {PHRASES[hit[0]]}" for number, line in lines for hit in words.finditer(line)]
    return found
