"""Which tests `make check` runs, which of `make test` begin first, and which run in one process.

`make check`: direct ones of every layer, those that take little. All others are marked ``slow``, so
a new file belongs to `make test` alone until it is named here. What only draws or breaks more of
what another test does is marked ``soak`` where it stands: `make soak` runs it.
"""

FAST = (
    "test_draws.py",
    "test_errors.py",
    "test_layers.py",
    "test_limits.py",
    "test_package.py",
    "test_tiers.py",
    "test_tolerances.py",
    "bodies/test_straight_patches.py",
    "cli/test_law_options.py",
    "control/test_growth.py",
    "geometry/test_ellipsoid_patches.py",
    "geometry/test_intervals.py",
    "geometry/test_nurbs.py",
    "geometry/test_tight_boxes.py",
    "kernels/test_certificate.py",
    "kernels/test_certified.py",
    "kernels/test_cold_start.py",
    "kernels/test_contact_newton.py",
    "kernels/test_depth_descent.py",
    "kernels/test_descent.py",
    "kernels/test_difference_hull.py",
    "kernels/test_frame_answer.py",
    "kernels/test_jets.py",
    "kernels/test_line_roots.py",
    "kernels/test_depth_penetration.py",
    "kernels/test_prediction.py",
    "kernels/test_rank_rule.py",
    "kernels/test_switching.py",
    "kernels/test_system.py",
    "kernels/test_trimming.py",
    "kernels/test_verdict.py",
    "motion/test_bounds.py",
    "motion/test_pose.py",
    "motion/test_rotations.py",
    "motion/test_samples.py",
    "motion/test_twist.py",
    "recording/test_recording_file.py",
    "scene/test_scene_motions.py",
    "scene/test_scene_refusals.py",
    "simulation/test_simulated_device.py",
    "simulation/test_system_input.py",
    "soak/test_checks.py",
    "tracking/test_bad_input.py",
    "tracking/test_branches.py",
    "tracking/test_coincident.py",
    "tracking/test_feedback.py",
    "tracking/test_golden.py",
    "tracking/test_laws_as_values.py",
    "tracking/test_pair_system.py",
)

SHARED_RUNS = (
    "paper/test_broken_on_purpose.py",
    "paper/test_claims.py",
    "paper/test_resets.py",
    "paper/test_simulation_a.py",
    "paper/test_simulation_b.py",
    "paper/test_simulation_c.py",
    "paper/test_simulation_d.py",
    "paper/test_simulation_e.py",
)
"""Files that look at the same runs of simulations, which take long and are kept in a process."""

SHARED_LIBRARY = ("c_interface/test_c_interface.py", "c_interface/test_solids.py")
"""Files whose programs link with the C library, which takes two minutes to build."""

TOGETHER = (SHARED_RUNS, SHARED_LIBRARY)
"""Files that one process runs: what they share is made once."""

LONG = (
    *SHARED_RUNS,
    *SHARED_LIBRARY,
    "test_docs.py",
    "soak/test_soak_command.py",
    "solids/test_rounded_beside_solids.py",
    "scene/test_bodies_of_own_files.py",
    "bodies/test_refined_knots.py",
    "bodies/test_pickled_bodies.py",
    "view/test_browser.py",
    "solids/test_self_intersections.py",
    "test_imports.py",
    "geometry/test_patch_bounds.py",
    "bodies/test_voronoi_planar.py",
    "view/test_world_page.py",
    "kernels/test_shipped.py",
    "bodies/test_taylor_proofs.py",
    "fuzz/test_hostile_arguments.py",
    "view/test_reading.py",
    "bodies/test_interval_proofs.py",
    "kernels/test_notices.py",
    "kernels/test_bounds_check.py",
    "tracking/test_point_switches.py",
    "tracking/test_touching.py",
    "kernels/test_modules.py",
    "oracles/test_oracles.py",
    "paper/test_control_figures.py",
    "bodies/test_boundary.py",
    "cad/test_cad_reading.py",
    "paper/test_variants.py",
    "bodies/test_swept_proofs.py",
    "solids/test_tracked_minima.py",
    "tracking/test_smooth_frame.py",
    "bodies/test_patch_proofs.py",
    "tracking/test_degenerate.py",
    "tracking/test_penetration.py",
    "solids/test_screws.py",
    "solids/test_solid_pictures.py",
    "kernels/test_contact_newton.py",
)
"""Files that take longest, the longest first."""
