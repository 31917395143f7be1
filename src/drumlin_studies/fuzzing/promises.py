"""The promises of drumlin, each with the test that holds it, and the meanings of exit statuses.

A test checks that these tests exist.
"""

PROMISES = [
    {"promise": promise, "test": test}
    for promise, test in (
        (
            "Bad input ends in one line and status 2.",
            "test_faults.py::test_no_broken_input_ends_in_a_fault",
        ),
        (
            "A process of its own ends alike.",
            "test_faults.py::test_a_process_of_its_own_ends_alike",
        ),
        (
            "Any exception ends in one line and its status.",
            "test_files.py::test_every_exception_ends_in_one_line_and_a_status",
        ),
        (
            "A signal ends in 128 and its number; no temporary file and no child stays.",
            "test_processes.py::test_a_signal_leaves_no_temporary_file_and_no_child",
        ),
        (
            "A full disk is one line in every writer.",
            "test_processes.py::test_a_disk_that_is_full_is_one_line_in_every_writer",
        ),
        ("Too little memory is one line.", "test_processes.py::test_too_little_memory_is_one_line"),
        (
            "Names reach the terminal escaped.",
            "test_processes.py::test_names_reach_the_terminal_escaped",
        ),
        (
            "An answer that is not finite is none.",
            "test_trust.py::test_an_answer_that_is_not_finite_is_none",
        ),
        (
            "Running in says no number that is not finite.",
            "test_trust.py::test_running_in_says_no_number_that_is_not_finite",
        ),
        (
            "Only regular files are replaced, links are followed.",
            "test_files.py::test_a_link_stays_and_its_target_is_replaced",
        ),
        (
            "Files are UTF-8 in every locale.",
            "test_processes.py::test_files_are_utf_8_in_the_locale_c",
        ),
        (
            "Nothing is imported from the current folder.",
            "test_processes.py::test_nothing_is_imported_from_the_current_folder",
        ),
        (
            "A foreign study is run by its path only.",
            "test_processes.py::test_a_foreign_study_is_run_by_its_path_only",
        ),
        (
            "A killed sweep resumed has the same bytes, no case is solved twice.",
            "test_sweep_stopped.py::test_killed_at_five_random_moments",
        ),
        (
            "A damaged journal costs the damaged records alone.",
            "test_journal.py::test_damage_costs_the_damaged_records_alone",
        ),
        (
            "A lost cluster is one line, and the finished cases stay.",
            "test_sweep_stopped.py::test_a_lost_cluster_is_one_line_and_the_finished_cases_stay",
        ),
        (
            "One and two jobs give the same bytes.",
            "test_sweep_stopped.py::test_one_and_two_jobs_and_a_damaged_journal_give_the_same_bytes",
        ),
        (
            "The number of threads moves torques and forces by less than 1e-10, "
            "pressures by 1e-7 of the largest.",
            "test_determinism.py::test_the_number_of_threads_moves_no_number",
        ),
        (
            "Equal runs write equal files but for times.",
            "test_determinism.py::test_equal_runs_write_equal_files_but_for_times",
        ),
        (
            "Stated errors are not too small, nor needlessly large: "
            "judged by stored far finer solutions.",
            "test_stored_truths.py::test_stated_errors_are_large_enough_and_no_larger_than_they_were",
        ),
        (
            "A stated error that is halved or doubled turns a test red.",
            "test_stored_truths.py::test_a_quantity_whose_stated_errors_are_halved_or_doubled_is_noticed",
        ),
        (
            "The second solver shares nothing with the first but the brake; "
            "a package imports only those below it.",
            "Makefile::lint-imports",
        ),
        (
            "Forces and moments balance; where p(θ) balances worse, that is said.",
            "test_trust.py::test_the_balance_of_the_printed_pressure_is_said_where_it_is_the_worse",
        ),
        (
            "Of two stable answers the one that friction leads to is given.",
            "test_locking.py::test_of_two_stable_answers_the_one_that_friction_leads_to",
        ),
        (
            "Reference values of another brake are refused.",
            "test_reference.py::test_curves_that_stop_short_and_references_of_other_brakes_are_refused",
        ),
        (
            "The holding brake goes through full slip and back, to the torque of the sliding drum.",
            "test_holding.py::test_random_brakes_go_through_full_slip_and_back",
        ),
        (
            "The holding brake's history is that of an independent solver by Newton's method.",
            "test_holding.py::test_both_paths_lead_to_the_answer_of_newtons_method",
        ),
        (
            "The holding brake's history converges with the increment.",
            "test_holding.py::test_the_history_converges_with_the_increment",
        ),
        (
            "No comparison is passed by what is not a number.",
            "test_trust.py::test_a_shoe_is_not_taken_as_rigid_where_that_cannot_be_judged",
        ),
        (
            "A peak pressure is said even of a contact at the lining's very end.",
            "test_trust.py::test_a_contact_within_the_lining_s_end_has_a_peak_pressure",
        ),
        (
            "A contact too short to be seen has a torque; its pressure is said to be unknown.",
            "test_trust.py::test_of_a_contact_too_short_to_be_seen_the_torque_is_known_and_the_pressure_is_not",
        ),
        (
            "What is in a mesh file tells cases of a sweep apart, not its name.",
            "test_sweep_attempts.py::test_what_is_in_a_mesh_file_tells_cases_apart_not_its_name",
        ),
        (
            "A sweep keeps only answers and refusals of physics and input.",
            "test_sweep_attempts.py::test_only_answers_and_refusals_of_the_case_itself_are_kept",
        ),
        (
            "The journal of another drumlin is kept aside.",
            "test_journal.py::test_the_journal_of_another_program_is_kept_aside",
        ),
        (
            "A file that is no journal is left alone.",
            "test_journal.py::test_a_file_that_is_no_journal_is_left_alone",
        ),
        (
            "A mesh with hinge and actuation swapped is refused.",
            "test_trust.py::test_a_mesh_with_hinge_and_actuation_swapped_is_refused",
        ),
        (
            "A mesh in the drum is warned of, then refused.",
            "test_trust.py::test_a_mesh_that_lies_in_the_drum_is_said_and_then_refused",
        ),
        (
            "Shoes that lie in each other are said.",
            "test_trust.py::test_shoes_that_lie_in_each_other_are_said",
        ),
        (
            "Strains beyond small ones are warned of, then refused.",
            "test_trust.py::test_a_lining_pressed_in_too_far_is_said_and_then_refused",
        ),
        (
            "Figures of merit hold wherever the lining lies.",
            "test_trust.py::test_eta_is_its_own_formula_wherever_the_lining_lies",
        ),
        (
            "No output is an input, however it is spelled.",
            "test_files.py::test_no_output_is_an_input_however_it_is_spelled",
        ),
        (
            "The mode of a file is kept; a new one has what the umask leaves.",
            "test_files.py::test_the_mode_of_a_file_is_kept",
        ),
        ("Devices and pipes are written to.", "test_files.py::test_a_pipe_is_written_to_and_read"),
        (
            "No cell is a formula.",
            "test_files.py::test_a_text_that_a_spreadsheet_would_compute_is_led_by_an_apostrophe",
        ),
        (
            "A page shows what was typed, without the machine's folders.",
            "test_files.py::test_a_page_shows_what_was_typed_without_the_machine_s_folders",
        ),
        (
            "A .vtu is bounded before it is unpacked.",
            "test_faults.py::test_a_small_vtu_that_unpacks_to_much_is_refused_before",
        ),
        (
            "The sets of an .inp are bounded before they are made.",
            "test_faults.py::test_sets_of_a_mesh_that_fill_the_memory_are_refused_before",
        ),
        (
            "As a mesh a pipe, a device, a folder, or a file that is too long is refused at once.",
            "test_files.py::test_what_is_no_mesh_is_refused_at_once",
        ),
        (
            "The brake file that the page saves is the same brake, "
            "whatever files and folders are called.",
            "test_explore_saved.py::test_the_saved_file_is_the_same_brake_whatever_the_file_was_called",
        ),
        (
            "Texts are limited before a parser sees them.",
            "test_files.py::test_texts_are_limited_before_a_parser_sees_them",
        ),
        (
            "A usage error is one line.",
            "test_processes.py::test_a_usage_error_is_one_line_with_status_2",
        ),
        (
            "A closed or full standard output is one line.",
            "test_processes.py::test_streams_that_are_closed_or_full",
        ),
        (
            "Letters that the font lacks are silent.",
            "test_processes.py::test_an_unknown_backend_and_letters_that_the_font_lacks_are_silent",
        ),
        (
            "What is no Dask scheduler, or never answers, is one line.",
            "test_sweep_stopped.py::test_what_is_no_scheduler_is_refused_in_one_line",
        ),
        (
            "A Dask worker that is killed costs nothing.",
            "test_sweep_stopped.py::test_a_dask_worker_is_killed",
        ),
        (
            "A case that kills its workers is a failed row, and the rest goes on.",
            "test_sweep_attempts.py::test_a_case_that_kills_its_workers_is_a_failed_row_and_the_rest_goes_on",
        ),
        (
            "The page to play with answers this machine alone.",
            "test_explore.py::test_only_this_machine_is_answered_by_its_own_name",
        ),
        (
            "Forty families of benchmarks hold, none judged by drumlin's own earlier output.",
            "test_ladder.py::test_the_ladder_has_forty_families_each_with_its_source",
        ),
        (
            "The lower bounds and the newest versions of the libraries pass the tests.",
            "Makefile::oldest newest",
        ),
    )
]
"""Each promise with its test, as rows of a table."""

STATUS_MEANINGS = [
    {"status": status, "meaning": meaning}
    for status, meaning in (
        ("0", "an answer"),
        ("2", "bad input; one line says what is allowed"),
        ("3", "no answer; one line says why: self-locking, not converged, no memory, a full disk"),
        ("1", "a fault of drumlin itself; one line says where"),
        ("130, 143", "stopped: by Ctrl-C, by SIGTERM (128 and the signal's number)"),
        ("141", "whoever read the output closed it"),
    )
]
"""Each exit status with its meaning, as rows of a table."""
