"""The base of every other room: array types, texts, errors, files, journals and LAPACK.

The room is for the parts that know nothing of brakes; it imports nothing else of drumlin. Values
and exceptions come in as plain Python and numpy objects. Lines for people, the exceptions BadInput
and NoAnswer, files that are written whole or not at all, and the journals of long runs go out.
"""
