"""Playing with a brake on a local page: sliders in, pressure and torque out.

- `knobs`: the sliders, and the link that keeps their setting.
- `answers`: finite elements beside a law for a setting. Intermediate results are kept from one
  setting to the next.
- `picture`: an answer as plain data to draw.
- `page`: the addresses and their replies.
- `serve`: the server, by the standard library.

A link names a setting, so that the server keeps nothing of a browser. The page draws itself: a
picture is a few paths and words, some 10 kB.
"""
