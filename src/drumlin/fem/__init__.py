"""The finite-element model: plane stress, shoe and lining against the drum in unilateral frictional
contact.
"""
