# SPDX-License-Identifier: MIT
"""A line field with a trisector where we say, along a stroke."""
import numpy as np

import alcap

surface = alcap.connect(alcap.Surface(*alcap.shapes.bumpy_sphere(4, 0.2, 3.0)))
angles = np.linspace(0, np.pi / 2, 20)
drawn = np.stack([np.cos(angles), np.sin(angles), 0.2 * np.ones(20)], axis=1)  # near the surface is enough
line = alcap.stroke_from_space(surface, drawn)

designer = alcap.Designer(surface, n=2)
stroke = designer.add(alcap.Stroke(line, weight=100.0))
saddle = designer.add(alcap.SingularityTarget(face=2000, sign=-1))
result = designer.solve()
for control in result.controls:
    print('met' if control['met'] else 'not met', f'{control["error_degrees"]:.2f} degrees')
assert result.controls[0]['met']
found = alcap.find_singularities(surface, result.field)
print(len(found), 'singularities; indices sum to', found['index'].sum() / 2)
assert found['index'].sum() == 2 * surface.euler
