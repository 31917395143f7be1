"""The promises of drumlin to its users, the tests that check them, and its exit statuses.

A further test checks that each test named here exists.
"""

PROMISES_WITH_THEIR_TESTS = [
    {"promise": promise, "test": test}
    for promise, test in (
        (
            "drumlin answers bad input with one line and exit status 2.",
            "test_faults.py::test_no_broken_input_ends_in_a_fault",
        ),
        (
            "An input has the same result in a process of its own as in a process with other "
            "inputs.",
            "test_faults.py::test_a_process_of_its_own_ends_alike",
        ),
        (
            "Any exception gives one line and the exit status of its kind.",
            "test_files.py::test_every_exception_ends_in_one_line_and_a_status",
        ),
        (
            "After a signal the exit status is 128 plus the number of the signal, and no "
            "temporary file or child process remains.",
            "test_processes.py::test_a_signal_leaves_no_temporary_file_and_no_child",
        ),
        (
            "If the disk is full, drumlin prints one line, whichever file it was writing.",
            "test_processes.py::test_a_disk_that_is_full_is_one_line_in_every_writer",
        ),
        (
            "If the memory is too small, drumlin prints one line.",
            "test_processes.py::test_too_little_memory_is_one_line",
        ),
        (
            "Control characters in names are escaped before they reach the terminal.",
            "test_processes.py::test_names_reach_the_terminal_escaped",
        ),
        (
            "drumlin refuses an answer that contains a number that is not finite.",
            "test_trust.py::test_an_answer_that_is_not_finite_is_none",
        ),
        (
            "drumlin wear prints only finite numbers.",
            "test_trust.py::test_running_in_says_no_number_that_is_not_finite",
        ),
        (
            "drumlin replaces only regular files, and follows links.",
            "test_files.py::test_a_link_stays_and_its_target_is_replaced",
        ),
        (
            "All files are written in UTF-8, in every locale.",
            "test_processes.py::test_files_are_utf_8_in_the_locale_c",
        ),
        (
            "drumlin imports no module from the current folder.",
            "test_processes.py::test_nothing_is_imported_from_the_current_folder",
        ),
        (
            "A study that does not belong to drumlin runs only if its path is given.",
            "test_processes.py::test_a_foreign_study_is_run_by_its_path_only",
        ),
        (
            "A sweep that was killed and resumed writes the same bytes as an undisturbed sweep, "
            "and solves no case twice.",
            "test_sweep_stopped.py::test_killed_at_five_random_moments",
        ),
        (
            "A damaged journal loses only its damaged records.",
            "test_journal.py::test_damage_costs_the_damaged_records_alone",
        ),
        (
            "If a cluster is lost, drumlin prints one line and keeps the finished cases.",
            "test_sweep_stopped.py::test_a_lost_cluster_is_one_line_and_the_finished_cases_stay",
        ),
        (
            "A sweep writes the same bytes with one job and with two jobs.",
            "test_sweep_stopped.py::test_one_and_two_jobs_and_a_damaged_journal_give_the_same_bytes",
        ),
        (
            "Another number of threads changes torques and forces by less than 1e-10 (relative), "
            "and pressures by less than 1e-7 of the largest pressure.",
            "test_determinism.py::test_the_number_of_threads_moves_no_number",
        ),
        (
            "Two equal runs write equal files, except for times.",
            "test_determinism.py::test_equal_runs_write_equal_files_but_for_times",
        ),
        (
            "Stated errors are neither too small nor needlessly large, compared with stored "
            "solutions that are far finer.",
            "test_stored_truths.py::test_stated_errors_are_large_enough_and_no_larger_than_they_were",
        ),
        (
            "If all stated errors of a quantity are halved or doubled, a test fails.",
            "test_stored_truths.py::test_a_quantity_whose_stated_errors_are_halved_or_doubled_is_noticed",
        ),
        (
            "The second solver shares only the brake with the first solver, and a package imports "
            "only packages below it.",
            "Makefile::lint-imports",
        ),
        (
            "Forces and moments are in balance. If the printed p(θ) is in worse balance, a line "
            "says so.",
            "test_trust.py::test_the_balance_of_the_printed_pressure_is_said_where_it_is_the_worse",
        ),
        (
            "If a brake has two stable answers, drumlin gives the answer that is followed as "
            "friction grows from zero.",
            "test_locking.py::test_of_two_stable_answers_the_one_that_friction_leads_to",
        ),
        (
            "drumlin check refuses reference values of another brake.",
            "test_reference.py::test_curves_that_stop_short_and_references_of_other_brakes_are_refused",
        ),
        (
            "A holding brake that is turned to full slip, in both senses, has the torque of the "
            "sliding brake.",
            "test_holding.py::test_random_brakes_go_through_full_slip_and_back",
        ),
        (
            "The states of a holding brake agree with an independent solver by Newton's method.",
            "test_holding.py::test_both_paths_lead_to_the_answer_of_newtons_method",
        ),
        (
            "The states of a holding brake converge when the increments of the rotation become "
            "smaller.",
            "test_holding.py::test_the_history_converges_with_the_increment",
        ),
        (
            "A value that is not a number passes no comparison.",
            "test_trust.py::test_a_shoe_is_not_taken_as_rigid_where_that_cannot_be_judged",
        ),
        (
            "A contact at the very end of the lining has a peak pressure in the answer as well.",
            "test_trust.py::test_a_contact_within_the_lining_s_end_has_a_peak_pressure",
        ),
        (
            "If a contact is too short for its pressure to be computed, drumlin gives the torque "
            "and says that the pressure is unknown.",
            "test_trust.py::test_of_a_contact_too_short_to_be_seen_the_torque_is_known_and_the_pressure_is_not",
        ),
        (
            "A sweep identifies a mesh file by its content, not by its name.",
            "test_sweep_attempts.py::test_what_is_in_a_mesh_file_tells_cases_apart_not_its_name",
        ),
        (
            "The journal of a sweep keeps only answers, and refusals that follow from the physics "
            "or the input of the case.",
            "test_sweep_attempts.py::test_only_answers_and_refusals_of_the_case_itself_are_kept",
        ),
        (
            "The journal of another version of drumlin is kept under another name.",
            "test_journal.py::test_the_journal_of_another_program_is_kept_aside",
        ),
        (
            "drumlin does not change a file that is no journal.",
            "test_journal.py::test_a_file_that_is_no_journal_is_left_alone",
        ),
        (
            "drumlin refuses a mesh whose groups hinge and actuation are interchanged.",
            "test_trust.py::test_a_mesh_with_hinge_and_actuation_swapped_is_refused",
        ),
        (
            "If a mesh overlaps the drum a little, a line warns; if it overlaps more, drumlin "
            "refuses it.",
            "test_trust.py::test_a_mesh_that_lies_in_the_drum_is_said_and_then_refused",
        ),
        (
            "If two shoes overlap, a line says so.",
            "test_trust.py::test_shoes_that_lie_in_each_other_are_said",
        ),
        (
            "If strains are too large for the theory of small strains, a line warns; if they are "
            "much too large, drumlin refuses the brake.",
            "test_trust.py::test_a_lining_pressed_in_too_far_is_said_and_then_refused",
        ),
        (
            "The figures of merit satisfy their formulas for any position of the lining.",
            "test_trust.py::test_eta_is_its_own_formula_wherever_the_lining_lies",
        ),
        (
            "drumlin never writes an output over an input, even if both paths are spelled "
            "differently.",
            "test_files.py::test_no_output_is_an_input_however_it_is_spelled",
        ),
        (
            "A replaced file keeps its permissions. A new file has the permissions that the umask "
            "allows.",
            "test_files.py::test_the_mode_of_a_file_is_kept",
        ),
        (
            "drumlin can write to devices and pipes.",
            "test_files.py::test_a_pipe_is_written_to_and_read",
        ),
        (
            "No cell of a table is a formula for a spreadsheet.",
            "test_files.py::test_a_text_that_a_spreadsheet_would_compute_is_led_by_an_apostrophe",
        ),
        (
            "A report shows the path that the user typed, without other folders of the machine.",
            "test_files.py::test_a_page_shows_what_was_typed_without_the_machine_s_folders",
        ),
        (
            "drumlin checks the size of compressed data in a .vtu before it expands the data.",
            "test_faults.py::test_a_small_vtu_that_unpacks_to_much_is_refused_before",
        ),
        (
            "drumlin checks the size of the sets of an .inp before it expands the sets.",
            "test_faults.py::test_sets_of_a_mesh_that_fill_the_memory_are_refused_before",
        ),
        (
            "drumlin refuses a pipe, a device, a folder or a file that is too long at once, if it "
            "is given as a mesh.",
            "test_files.py::test_what_is_no_mesh_is_refused_at_once",
        ),
        (
            "A brake file that the explorer saves describes the same brake, for any names of "
            "files and folders.",
            "test_explore_saved.py::test_the_saved_file_is_the_same_brake_whatever_the_file_was_called",
        ),
        (
            "drumlin checks the length of texts before it parses them.",
            "test_files.py::test_texts_are_limited_before_a_parser_sees_them",
        ),
        (
            "A wrong option or argument gives one line.",
            "test_processes.py::test_a_usage_error_is_one_line_with_status_2",
        ),
        (
            "If the standard output is closed or full, drumlin prints one line.",
            "test_processes.py::test_streams_that_are_closed_or_full",
        ),
        (
            "Letters that the font of a figure lacks give no warning.",
            "test_processes.py::test_an_unknown_backend_and_letters_that_the_font_lacks_are_silent",
        ),
        (
            "If an address is no Dask scheduler, or does not answer, drumlin prints one line.",
            "test_sweep_stopped.py::test_what_is_no_scheduler_is_refused_in_one_line",
        ),
        (
            "If a Dask worker is killed, no case is lost.",
            "test_sweep_stopped.py::test_a_dask_worker_is_killed",
        ),
        (
            "A case that kills its workers becomes a failed row, and the other cases continue.",
            "test_sweep_attempts.py::test_a_case_that_kills_its_workers_is_a_failed_row_and_the_rest_goes_on",
        ),
        (
            "The page of drumlin explore answers only requests from this machine.",
            "test_explore.py::test_only_this_machine_is_answered_by_its_own_name",
        ),
        (
            "Forty families of cases with known answers agree with these answers, none of "
            "which comes from an earlier drumlin.",
            "test_ladder.py::test_the_ladder_has_forty_families_each_with_its_source",
        ),
        (
            "The lower bounds and the newest versions of the libraries pass the tests.",
            "Makefile::oldest newest",
        ),
    )
]
"""Rows of a table: each promise of drumlin, and the test that checks it."""

STATUS_MEANINGS = [
    {"status": status, "meaning": meaning}
    for status, meaning in (
        ("0", "an answer"),
        ("2", "bad input; one line says what is allowed"),
        ("3", "no answer; one line says why: self-locking, not converged, no memory, a full disk"),
        ("1", "a fault of drumlin itself; one line says where"),
        ("130, 143", "a stop by Ctrl-C or by SIGTERM: 128 plus the number of the signal"),
        ("141", "the program that read the output has ended"),
    )
]
"""Rows of a table: each exit status of drumlin's command line, and its meaning."""
