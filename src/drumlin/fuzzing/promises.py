"""What drumlin promises, each with the test that holds it; a test checks that these tests exist."""

PROMISES = [
    {"promise": promise, "test": test}
    for promise, test in (
        ("Bad input ends in one line and status 2.", "test_faults.py::test_no_broken_input_ends_in_a_fault"),
        ("A process of its own ends alike.", "test_faults.py::test_a_process_of_its_own_ends_alike"),
        ("Any exception ends in one line and its status.",
         "test_files.py::test_every_exception_ends_in_one_line_and_a_status"),
        ("A signal ends in 128 and its number; no temporary file and no child stays.",
         "test_processes.py::test_a_signal_leaves_no_temporary_file_and_no_child"),
        ("A full disk is one line in every writer.",
         "test_processes.py::test_a_disk_that_is_full_is_one_line_in_every_writer"),
        ("Too little memory is one line.", "test_processes.py::test_too_little_memory_is_one_line"),
        ("Names reach the terminal escaped.", "test_processes.py::test_names_reach_the_terminal_escaped"),
        ("An answer that is not finite is none.", "test_trust.py::test_an_answer_that_is_not_finite_is_none"),
        ("Running in says no number that is not finite.",
         "test_trust.py::test_running_in_says_no_number_that_is_not_finite"),
        ("Only regular files are replaced, links are followed.",
         "test_files.py::test_a_link_stays_and_its_target_is_replaced"),
        ("Files are UTF-8 in every locale.", "test_processes.py::test_files_are_utf_8_in_the_locale_c"),
        ("Nothing is imported from the current folder.",
         "test_processes.py::test_nothing_is_imported_from_the_current_folder"),
        ("A foreign study is run by its path only.",
         "test_processes.py::test_a_foreign_study_is_run_by_its_path_only"),
        ("A killed sweep resumed has the same bytes, no case is solved twice.",
         "test_sweep_stopped.py::test_killed_at_five_random_moments"),
        ("A damaged journal costs the damaged records alone.",
         "test_journal.py::test_damage_costs_the_damaged_records_alone"),
        ("A lost cluster is one line, and the finished cases stay.",
         "test_sweep_stopped.py::test_a_lost_cluster_is_one_line_and_the_finished_cases_stay"),
        ("One and two jobs give the same bytes.",
         "test_sweep_stopped.py::test_one_and_two_jobs_and_a_damaged_journal_give_the_same_bytes"),
        ("The number of threads moves torques and forces by less than 1e-10, pressures by 1e-7 of the largest.",
         "test_determinism.py::test_the_number_of_threads_moves_no_number"),
        ("Equal runs write equal files but for times.",
         "test_determinism.py::test_equal_runs_write_equal_files_but_for_times"),
        ("Stated errors are held against true ones, by a second solver.",
         "test_stated_true.py::test_what_a_response_states_is_held_against_the_truth"),
        ("The second solver shares nothing with the first but the brake; a package imports only those below it.",
         "Makefile::lint-imports"),
        ("Forces and moments balance; where p(θ) balances worse, that is said.",
         "test_trust.py::test_the_balance_of_the_printed_pressure_is_said_where_it_is_the_worse"),
        ("Of two stable answers the one that friction leads to is given.",
         "test_locking.py::test_of_two_stable_answers_the_one_that_friction_leads_to"),
        ("Reference values of another brake are refused.",
         "test_reference.py::test_curves_that_stop_short_and_references_of_other_brakes_are_refused"),
    )
]  # fmt: skip

STATUSES = [
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
