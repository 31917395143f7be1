"""A page in the browser with sliders for a brake, which shows its pressure and torque at once.

- `knobs`: the sliders, and the link that holds their positions.
- `answers`: the brake solved by finite elements and by a law for given slider positions.
  Intermediate results are kept for the next positions.
- `picture`: an answer as plain data to draw.
- `page`: the addresses of the page and the replies to them.
- `serve`: the web server, made of Python's standard library.

The link of the page holds the positions of all sliders, so that the server stores nothing about a
browser. The script of the page draws the picture from data of some 10 kB.
"""
